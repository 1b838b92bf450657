// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/error.hpp>
#include <dyn/owned.hpp>

#include <utility>

namespace dyn {

namespace {
std::string compose(const std::string& message, const Where& where) {
  std::string text;
  if (!where.file.empty()) {
    text = where.file;
    if (where.line > 0) text += ":" + std::to_string(where.line);
    text += ": ";
  }
  if (!where.joint.empty()) text += "joint '" + where.joint + "': ";
  return text + message;
}
}  // namespace

Error::Error(ErrorCode code, const std::string& message, Where where)
    : std::runtime_error(compose(message, where)), code_(code), where_(std::move(where)) {}

namespace detail {
void refuseMovedFrom() { throw Error(ErrorCode::argument, "an object is used that was moved from; assign to it first, or use what it was moved to"); }
}  // namespace detail

}  // namespace dyn
