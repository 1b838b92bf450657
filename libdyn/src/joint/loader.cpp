// SPDX-License-Identifier: BSD-2-Clause
#include "joint/loader.hpp"

#include "floating_point.hpp"
#include "joint/trial_load.hpp"

#include <dyn_sdk/stamp.hpp>

#include <boost/dll/shared_library.hpp>

#include <dlfcn.h>

#include <cstring>
#include <deque>
#include <filesystem>
#include <mutex>

namespace dyn {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) { throw Error(ErrorCode::plugin, why, {path, 0, ""}); }

constexpr const char* or_any = ", or load it with Trust::any";

/// Whether the file is a build of the standard plugin, which comes with the library and can be trusted as much.
bool partOfLibrary(const fs::path& file) { return file.filename() == "dyn_standard.so" && file.string().starts_with(builtinPluginDirectory() + "/"); }

void requireTrusted(const std::string& problem, const std::string& path) {
  if (!problem.empty()) refuse(path, "refused: " + problem);
}

/// Checks the folder of each link on the path, too: whoever can write there decides what is loaded.
void checkLinks(const fs::path& way, const std::string& path) {
  fs::path walked;
  for (auto part = way.begin(); part != way.end(); ++part) {
    std::error_code error;
    const fs::path next = walked / *part, target = fs::read_symlink(next, error);
    if (error == std::errc::invalid_argument) {  // not a link
      walked = next;
      continue;
    }
    if (error) refuse(path, "refused: '" + next.string() + "' cannot be looked at: " + error.message());
    requireTrusted(untrustedFolder(walked.string(), or_any), path);
    fs::path rest = walked / target;
    while (++part != way.end()) rest /= *part;
    return checkLinks(rest, path);
  }
}

void compareStamps(const dyn_plugin_stamp& theirs, const std::string& path) {
  const dyn_plugin_stamp ours = sdk::stamp();
  const auto differ = [&](const char* field, const std::string& has, const std::string& wants) {
    refuse(path, std::string("plugin was built for another libdyn: ") + field + " is " + has + ", this library has " + wants +
                     "; rebuild the plugin against this libdyn");
  };
  if (theirs.magic != ours.magic) refuse(path, "its descriptor is not one of libdyn's");
  if (theirs.abi_version != ours.abi_version) differ("ABI version", std::to_string(theirs.abi_version), std::to_string(ours.abi_version));
  if (theirs.descriptor_size != ours.descriptor_size)
    differ("descriptor size", std::to_string(theirs.descriptor_size), std::to_string(ours.descriptor_size));
  if (std::strncmp(theirs.compiler_abi, ours.compiler_abi, sizeof ours.compiler_abi) != 0)
    differ("compiler ABI", std::string(theirs.compiler_abi, strnlen(theirs.compiler_abi, sizeof theirs.compiler_abi)), ours.compiler_abi);
  if (theirs.layout != ours.layout) differ("layout stamp", std::to_string(theirs.layout), std::to_string(ours.layout));
}

constexpr auto load_mode = static_cast<boost::dll::load_mode::type>(boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local);

/// Keeps a library open for the life of the process: types, models made of them, and copies of functions may be anywhere.
boost::dll::shared_library& keep(boost::dll::shared_library library) {
  static std::mutex mutex;
  static auto& all = *new std::deque<boost::dll::shared_library>;
  const std::lock_guard lock(mutex);
  all.push_back(std::move(library));
  return all.back();
}

template <class Info>
void readInfo(const Info& info) {
  [[maybe_unused]] volatile std::size_t letters = 0;
  const auto read = [&](const char* text) {
    if (text != nullptr) letters = std::strlen(text);
  };
  read(info.name);
  read(info.summary);
  for (int i = 0; i < info.parameter_count; ++i)
    for (const char* text : {info.parameters[i].name, info.parameters[i].unit, info.parameters[i].help, info.parameters[i].example}) read(text);
}

/// Reads everything that is read of a plugin before one of its types is used.
void readPlugin(void* library) {
  const auto entry = reinterpret_cast<const dyn_plugin_descriptor* (*)()>(dlsym(library, DYN_PLUGIN_ENTRY));
  const dyn_plugin_descriptor* d = entry != nullptr ? entry() : nullptr;
  if (d == nullptr) return;
  compareStamps(d->stamp, "");
  for (std::uint32_t i = 0; i < d->joint_type_count; ++i) readInfo(static_cast<const JointType*>(d->joint_types[i])->info());
  for (std::uint32_t i = 0; i < d->coupling_type_count; ++i) readInfo(static_cast<const CouplingType*>(d->coupling_types[i])->info());
}

/// Why dlopen() failed last, without the file's name at the beginning.
std::string loaderSays(const std::string& name) {
  const char* text = dlerror();
  std::string why = text != nullptr ? text : "the loader gives no reason";
  if (why.starts_with(name + ": ")) why.erase(0, name.size() + 2);
  return why;
}

}  // namespace

OpenedPlugin openPlugin(const std::string& path, Trust trust) {
  std::error_code error;
  const fs::path canonical = fs::canonical(path, error);
  if (error) refuse(path, "cannot find the plugin: " + error.message());
  const OpenFile file(canonical.string());
  if (!file.problem().empty()) refuse(path, file.problem());
  if (trust == Trust::owner_only) {
    checkLinks(fs::absolute(path), path);
    requireTrusted(untrustedFolder(canonical.parent_path().string(), or_any), path);
    requireTrusted(file.untrusted(or_any), path);
  }

  boost::dll::shared_library opened;
  std::string remark;
  std::string reason = partOfLibrary(canonical) ? "" : trialLoad(file, readPlugin);
  if (reason.empty()) try {
      const FloatingPointEnvironment kept;
      boost::dll::fs::error_code failed;
      opened.load(file.nameForLoader(), load_mode, failed);
      if (failed) {
        reason = loaderSays(file.nameForLoader());
      } else if (!keepsSmallNumbers()) {
        remark = "as it is loaded, it has the thread flush small numbers to zero (undone): link it without -ffast-math and -Ofast";
      }
    } catch (const std::exception& e) {
      reason = e.what();
    }
  if (!reason.empty()) refuse(path, "cannot be loaded: " + reason);
  boost::dll::shared_library& library = keep(std::move(opened));
  if (!library.has(DYN_PLUGIN_ENTRY)) refuse(path, "exports no " DYN_PLUGIN_ENTRY "; a plugin ends with DYN_EXPORT_JOINTS(...)");
  const dyn_plugin_descriptor* descriptor = nullptr;
  try {
    descriptor = library.get<const dyn_plugin_descriptor*()>(DYN_PLUGIN_ENTRY)();
  } catch (const std::exception& e) {
    refuse(path, std::string("threw while describing itself: ") + e.what());
  } catch (...) {
    refuse(path, "threw while describing itself");
  }
  if (descriptor == nullptr) refuse(path, "describes nothing");
  compareStamps(descriptor->stamp, path);
  return {*descriptor, remark};
}

void* openFunction(const OpenFile& file, const std::string& name) {
  boost::dll::fs::error_code error;
  boost::dll::shared_library opened(file.nameForLoader(), load_mode, error);
  if (error || !opened.has(name)) return nullptr;
  return reinterpret_cast<void*>(&keep(std::move(opened)).get<void()>(name));
}

std::string builtinPluginDirectory() { return (libraryFile().parent_path() / "libdyn" / "plugins").string(); }

}  // namespace dyn
