// SPDX-License-Identifier: BSD-2-Clause
#include "python_model.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>

extern char** environ;

namespace dyn::tool {

namespace {

namespace fs = std::filesystem;

// Exit codes tell who failed: 3, the module is missing; 4, the file, whose message is printed already.
const char* const script = R"(
import os, sys
sys.dont_write_bytecode = True
os.dup2(2, 1)
sys.path.append(sys.argv[4])
try:
    import libdyn
except ImportError as problem:
    print(problem, file=sys.stderr)
    sys.exit(3)
try:
    model = libdyn.load(sys.argv[1], root=sys.argv[2])
    text = model.to_json()
except libdyn.Error as problem:
    print(problem, file=sys.stderr)
    sys.exit(4)
plugins = [joint.path for joint in libdyn.joint.known() if joint.path is not None]
with open(sys.argv[3], "w") as file:
    file.write("".join(plugin + "\n" for plugin in plugins) + "\n" + text)
)";

/// A folder of this process, which goes with the object.
class Workplace {
 public:
  Workplace() {
    std::string pattern = (fs::temp_directory_path() / "dyn-model-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw Error(ErrorCode::file, "no temporary folder can be made", {pattern, 0, ""});
    path = pattern;
  }
  ~Workplace() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  fs::path path;
};

int runPython(const std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, words[0], nullptr, nullptr, words.data(), environ) != 0) throw pythonMissing(arguments[3]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string pythonModuleFolder() {
  std::error_code error;
  return (fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "python").string();
}

Error pythonMissing(const std::string& file) {
  return {ErrorCode::file, "there is no python3 to run it; install one (apt install python3)", {file, 0, ""}};
}

Error pythonModuleMissing(const std::string& file) {
  return {ErrorCode::file, "python3 has no module libdyn; install it (pip install ./libdyn/python), or name its folder in PYTHONPATH", {file, 0, ""}};
}

PythonModel runModelFile(const std::string& path, const std::string& root) {
  const Workplace workplace;
  const std::string result = (workplace.path / "model").string();
  readFile(path);  // says what is wrong with the file's name before python3 starts
  const int code = runPython({"python3", "-c", script, path, root, result, pythonModuleFolder()});
  if (code == 127) throw pythonMissing(path);
  if (code == 3) throw pythonModuleMissing(path);
  if (code != 0) throw Error(ErrorCode::model, "python3 ended with exit code " + std::to_string(code) + "; its message is above", {path, 0, ""});
  std::istringstream text(readFile(result));
  PythonModel out;
  for (std::string line; std::getline(text, line) && !line.empty();) out.plugins.push_back(line);
  const std::string json(std::istreambuf_iterator<char>(text), {});
  out.model = json::parse(json, path);
  return out;
}

}  // namespace dyn::tool
