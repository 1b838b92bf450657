// SPDX-License-Identifier: BSD-2-Clause
// Validators for the options of dyn's subcommands, and their error messages.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// Each accepts a finite number: one that is positive, one that is not negative, or one within a range.
CLI::Validator positive();
CLI::Validator notNegative();
CLI::Validator inRange(double low, double high);

/// Accepts the name of a file to read or write: any text that is not empty.
CLI::Validator fileName();
/// Accepts the name of a file to write, whose ending chooses one of several formats. If there is only one format, the ending may be missing.
CLI::Validator fileName(const std::vector<std::string>& endings, const std::string& what);

/// Adds --q, a named state of the model, in place of the states of another option.
void addNamedState(CLI::App& app, std::string& name, const std::string& other);

/// The message for a wrong command line, such as "dyn simulate: --time: ...": the error, and where to find help.
std::string refusal(const CLI::App* app, const CLI::Error& error);

}  // namespace dyn::tool
