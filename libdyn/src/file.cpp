#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace dyn {

void replaceFile(const std::string& path, const std::string& content) {
  const std::string temporary = path + ".part" + std::to_string(getpid());
  std::ofstream file(temporary, std::ios::binary);
  file << content;
  file.close();
  if (file && std::rename(temporary.c_str(), path.c_str()) == 0) return;
  const std::string why = std::strerror(errno);
  std::remove(temporary.c_str());
  throw Error(ErrorCode::file, "cannot be written: " + why, {path, 0, ""});
}

}  // namespace dyn
