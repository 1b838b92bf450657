// SPDX-License-Identifier: BSD-2-Clause
// The program that python3 runs to call a function for the samples of a sweep.
#pragma once

namespace dyn::tool::sweep {

/// Its argument is the folder of the module libdyn, where python3 looks last.
extern const char* const python_server;

}  // namespace dyn::tool::sweep
