#include "joint/loader.hpp"

#include "joint/trial_load.hpp"

#include <dyn_sdk/stamp.hpp>

#include <boost/dll/runtime_symbol_info.hpp>
#include <boost/dll/shared_library.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <filesystem>
#include <mutex>

namespace dyn {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) { throw Error(ErrorCode::plugin, why, {path, 0, ""}); }

/// Refuses a file or folder that anyone but this process's user and root could have made or can replace.
void requireOwned(const fs::path& p, const std::string& path) {
  struct stat s {};
  const auto untrusted = [&](const std::string& why, const char* cure) {
    refuse(path, "refused: '" + p.string() + "' " + why + "; " + cure + ", or load it with Trust::any");
  };
  if (stat(p.c_str(), &s) != 0) untrusted(std::string("cannot be looked at: ") + std::strerror(errno), "make it readable");
  if ((s.st_mode & (S_IWGRP | S_IWOTH)) != 0) untrusted("can be written by its group or by everyone", "run chmod go-w on it");
  if (s.st_uid != geteuid() && s.st_uid != 0) untrusted("belongs to another user, number " + std::to_string(s.st_uid), "copy it");
}

/// The folder of each link on the way must be owned, too: who writes one says what is loaded.
void checkLinks(const fs::path& way, const std::string& path) {
  fs::path walked;
  for (auto part = way.begin(); part != way.end(); ++part) {
    std::error_code error;
    const fs::path next = walked / *part, target = fs::read_symlink(next, error);
    if (error == std::errc::invalid_argument) {  // no link
      walked = next;
      continue;
    }
    if (error) refuse(path, "refused: '" + next.string() + "' cannot be looked at: " + error.message());
    requireOwned(walked, path);
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

/// Libraries are never closed: types, models made of them, and copies of functions may be anywhere.
boost::dll::shared_library& keep(boost::dll::shared_library library) {
  static std::mutex mutex;
  static auto& all = *new std::deque<boost::dll::shared_library>;
  const std::lock_guard lock(mutex);
  all.push_back(std::move(library));
  return all.back();
}

}  // namespace

const dyn_plugin_descriptor& openPlugin(const std::string& path, Trust trust) {
  std::error_code error;
  const fs::path file = fs::canonical(path, error);
  if (error) refuse(path, "cannot find the plugin: " + error.message());
  if (!fs::is_regular_file(file)) refuse(path, "is not a file");
  if (trust == Trust::owner_only) {
    checkLinks(fs::absolute(path), path);
    requireOwned(file.parent_path(), path);
    requireOwned(file, path);
  }

  boost::dll::shared_library opened;
  std::string reason = trialLoad(file.string());
  if (reason.empty()) try {
      opened.load(file.string(), load_mode);
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
  return *descriptor;
}

void* openFunction(const std::string& path, const std::string& name) {
  boost::dll::fs::error_code error;
  boost::dll::shared_library opened(path, load_mode, error);
  if (error || !opened.has(name)) return nullptr;
  return reinterpret_cast<void*>(&keep(std::move(opened)).get<void()>(name));
}

std::string builtinPluginDirectory() {
  const fs::path library = boost::dll::symbol_location_ptr(reinterpret_cast<const void*>(&openPlugin)).string();
  return (fs::path(library).parent_path() / "libdyn" / "plugins").string();
}

}  // namespace dyn
