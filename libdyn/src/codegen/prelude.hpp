// SPDX-License-Identifier: BSD-2-Clause
// The beginning of every generated source: the number type, its functions, and sines and cosines of many angles at once.
#pragma once

#include <string>

namespace dyn {

std::string codegenPrelude(bool single_precision, int lanes);

}  // namespace dyn
