// SPDX-License-Identifier: BSD-2-Clause
// Models that Python files make, and what every program of this command needs that python3 runs.
#pragma once

#include <dyn/error.hpp>
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

/// Returns the folder of the module in a build tree, beside the folder of this program. python3 knows that of an installed module.
std::string pythonModuleFolder();
/// Errors about the file that is to be run.
/// @{
Error pythonMissing(const std::string& file);
Error pythonModuleMissing(const std::string& file);
/// @}

}  // namespace dyn::tool
