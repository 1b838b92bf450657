// What the options of dyn's subcommands accept, and how they refuse the rest.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// A finite number that is positive, or not negative, or in a range.
CLI::Validator positive();
CLI::Validator notNegative();
CLI::Validator inRange(double low, double high);

/// The name of a file to read or write: any that is not empty.
CLI::Validator fileName();
/// The name of a file to write in one of several formats, which its ending chooses. Where there is one format alone, a name without ending will do.
CLI::Validator fileName(const std::vector<std::string>& endings, const std::string& what);

/// "dyn simulate: --time: ...": what is wrong with a command line, and where to read how it is written.
std::string refusal(const CLI::App* app, const CLI::Error& error);

}  // namespace dyn::tool
