// SPDX-License-Identifier: BSD-2-Clause
// Models that Python files make.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

struct PythonModel {
  Model model;
  std::vector<std::string> plugins;  ///< of joint types that the file defines
};

/// Runs python3 with the file and takes the `model` that it leaves. Text that the file prints goes to standard error. Throws Error(file) if python3
/// or the module libdyn is not there, and Error(model) if the file fails, after its own message.
PythonModel runModelFile(const std::string& path, const std::string& root);

}  // namespace dyn::tool
