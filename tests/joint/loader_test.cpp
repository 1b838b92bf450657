// SPDX-License-Identifier: BSD-2-Clause
// Shared objects with every known fault. Each gives an Error that names the file, and the registry stays as it was.
#include "support/folder.hpp"
#include "support/skip.hpp"

#include <dyn/compile/compile.hpp>

#include <elf.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

namespace {

namespace fs = std::filesystem;

const fs::path bad_plugins = fs::path(DYN_BINARY_DIR) / "bad_plugins";

/// A temporary folder to which a test copies shared objects.
struct Folder : dyn::test::Folder {
  fs::path copy(const std::string& file) const { return copy(file, file); }
  fs::path copy(const std::string& file, const fs::path& as) const {
    fs::path to = path / as;
    fs::create_directories(to.parent_path());
    fs::copy_file(bad_plugins / file, to);
    fs::permissions(to, fs::perms::owner_all);
    return to;
  }
};

struct Counts {
  std::size_t joints, couplings, plugins;
  explicit Counts(const dyn::JointRegistry& r) : joints(r.jointTypes().size()), couplings(r.couplingTypes().size()), plugins(r.plugins().size()) {}
  bool operator==(const Counts&) const = default;
};

/// Checks that loading fails with Error(plugin), that the message contains the path and all `words`, and that the registry is unchanged.
void requireRefused(const std::string& path, const std::vector<std::string>& words, dyn::Trust trust = dyn::Trust::any) {
  dyn::JointRegistry registry = dyn::JointRegistry::standard();
  const Counts before(registry);
  INFO(path);
  try {
    registry.load(path, trust);
    FAIL("was loaded");
  } catch (const dyn::Error& e) {
    INFO(e.what());
    CHECK(e.code() == dyn::ErrorCode::plugin);
    CHECK(e.where().file == path);
    CHECK(std::string(e.what()).find(path) != std::string::npos);
    for (const std::string& word : words) CHECK(std::string(e.what()).find(word) != std::string::npos);
  }
  CHECK(Counts(registry) == before);
  CHECK_NOTHROW(registry.jointType("revolute"));
}

std::string bad(const char* name) { return (bad_plugins / name).string(); }

}  // namespace

TEST_CASE("a file that is not there") { requireRefused("/nowhere/at_all.so", {"cannot find"}); }

TEST_CASE("a folder instead of a file") {
  const Folder folder;
  requireRefused(folder.path.string(), {"is not a file"});
}

TEST_CASE("a file that is no shared object, an empty one, a truncated one") {
  const Folder folder;
  const fs::path text = folder.path / "text.so", empty = folder.path / "empty.so", cut = folder.path / "cut.so";
  std::ofstream(text) << "this is no ELF file\n";
  std::ofstream(empty).flush();
  requireRefused(text.string(), {"cannot be loaded"});
  requireRefused(empty.string(), {"cannot be loaded"});
  fs::copy_file(bad("sound.so"), cut);
  fs::permissions(cut, fs::perms::owner_all);
  const std::uintmax_t whole = fs::file_size(cut);
  for (const std::uintmax_t size : {std::uintmax_t(3), std::uintmax_t(64), std::uintmax_t(100), std::uintmax_t(600), whole / 4, whole / 2}) {
    fs::resize_file(cut, size);
    requireRefused(cut.string(), {"cannot be loaded"});
    fs::copy_file(bad("sound.so"), cut, fs::copy_options::overwrite_existing);
  }
}

TEST_CASE("stamps of another library") {
  requireRefused(bad("wrong_abi_version.so"), {"ABI version is 99", "rebuild"});
  requireRefused(bad("wrong_layout.so"), {"layout stamp", "rebuild"});
}

TEST_CASE("a static constructor that throws, or ends the process") {
  for (int i = 0; i < 2; ++i) {  // the second attempt must fail as the first
    requireRefused(bad("throws_in_constructor.so"), {"static constructor", "no licence found"});
    requireRefused(bad("crashes_in_constructor.so"), {"static constructor"});
  }
  // The dynamic loader must not stay locked, so that another thread can still use it.
  std::thread([] { dyn::JointRegistry().load(bad("sound.so"), dyn::Trust::any); }).join();
}

TEST_CASE("a table of segments that would lead beyond the file's own memory is refused") {
  const dyn::test::Folder folder;
  std::ifstream in(bad("sound.so"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  Elf64_Ehdr header;
  std::memcpy(&header, bytes.data(), sizeof header);
  for (int i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    const std::size_t at = header.e_phoff + static_cast<std::size_t>(i) * sizeof segment;
    std::memcpy(&segment, bytes.data() + at, sizeof segment);
    if (segment.p_type != PT_LOAD && segment.p_type != PT_GNU_RELRO) continue;
    segment.p_vaddr += std::uint64_t{1} << 44;
    std::string damaged = bytes;
    std::memcpy(damaged.data() + at, &segment, sizeof segment);
    requireRefused(folder.write("damaged.so", damaged), {"table of segments is damaged"});
  }
}

TEST_CASE("a plugin that crashes while it is described, as one with damaged tables does") {
  requireRefused(bad("crashes_in_entry.so"), {"cannot be loaded", "reading its description crashes", "Segmentation"});
}

TEST_CASE("whatever runs as a file is opened is tried first, and must come to an end") {
  requireRefused(bad("exits_in_constructor.so"), {"static constructor", "ended the process"});
  requireRefused(bad("exits_while_linked.so"), {"cannot be loaded"});
  requireRefused(bad("never_ends_loading.so"), {"do not end within 10 s"});
}

TEST_CASE("a plugin that has small numbers flushed to zero changes nothing for its host, and it is said") {
  dyn::JointRegistry registry;
  registry.load(bad("flushes_to_zero.so"), dyn::Trust::any);
  volatile double smallest = 0x1p-1022, half = 0.5;
  CHECK(smallest * half == 0x1p-1023);
  CHECK(registry.plugins().at(0).remark.find("-ffast-math") != std::string::npos);
  registry.load(bad("sound.so"), dyn::Trust::any);
  CHECK(registry.plugins().at(1).remark.empty());
}

TEST_CASE("a file in folders that others can exchange is loaded as it was when it was judged", "[trust]") {
  const Folder open;
  const fs::path inner = open.path / "inner";
  const std::string file = open.copy("sound.so", fs::path("inner") / "sound.so").string();
  fs::permissions(open.path, fs::perms::all);
  dyn::JointRegistry registry;
  registry.load(file);
  CHECK_NOTHROW(registry.jointType("sound_slider"));
  // Another file must be loaded as another plugin, even if its file descriptor has the same number.
  registry.load(open.copy("never_ends_or_crashes.so", fs::path("inner") / "other.so").string());
  CHECK_NOTHROW(registry.jointType("sound_after_them"));
}

TEST_CASE("an entry point that throws, or is missing, or describes nothing") {
  requireRefused(bad("throws_in_entry.so"), {"threw while describing itself", "not today"});
  requireRefused(bad("exports_nothing.so"), {"exports no dyn_plugin_descriptor_v1"});
  requireRefused(bad("exports_no_types.so"), {"exports no joint types"});
}

TEST_CASE("a type that another plugin provides: the whole file is refused") {
  requireRefused(bad("duplicates_a_type.so"), {"'revolute' is already provided by", "dyn_standard.so"});
  dyn::JointRegistry registry = dyn::JointRegistry::standard();
  CHECK_THROWS_AS(registry.load(bad("duplicates_a_type.so"), dyn::Trust::any), dyn::Error);
  CHECK_THROWS_AS(registry.jointType("an_original"), dyn::Error);
}

TEST_CASE("a file or folder that others can write is refused unless trusted") {
  const Folder folder;
  const std::string file = folder.copy("sound.so").string();
  fs::permissions(file, fs::perms::group_write, fs::perm_options::add);
  requireRefused(file, {"can be written by", "chmod go-w"}, dyn::Trust::owner_only);
  fs::permissions(file, fs::perms::group_write, fs::perm_options::remove);
  fs::permissions(folder.path, fs::perms::others_write, fs::perm_options::add);
  requireRefused(file, {"can be written by", "chmod go-w"}, dyn::Trust::owner_only);
  dyn::JointRegistry trusting;
  CHECK_NOTHROW(trusting.load(file, dyn::Trust::any));
  fs::permissions(folder.path, fs::perms::others_write, fs::perm_options::remove);
  dyn::JointRegistry registry;
  CHECK_NOTHROW(registry.load(file));
}

TEST_CASE("links are followed, and it is the file behind them that is judged") {
  const Folder folder, elsewhere;
  const fs::path file = folder.copy("sound.so"), link = elsewhere.path / "link.so";
  fs::create_symlink(file, link);
  dyn::JointRegistry registry;
  registry.load(link.string());
  CHECK_NOTHROW(registry.jointType("sound_slider"));
  registry.load(file.string());  // the same file by another path
  CHECK(registry.jointTypes().size() == 1);
  fs::permissions(file, fs::perms::group_write, fs::perm_options::add);
  requireRefused(link.string(), {"can be written by"}, dyn::Trust::owner_only);
  const fs::path dangling = elsewhere.path / "dangling.so";
  fs::create_symlink(folder.path / "gone.so", dangling);
  requireRefused(dangling.string(), {"cannot find"});
}

TEST_CASE("a link that others can replace is refused, wherever on the way it lies", "[trust]") {
  const Folder folder, open;
  const fs::path file = folder.copy("sound.so"), link = open.path / "link.so", other = folder.path / "other.so", way = open.path / "way";
  fs::create_symlink(file, link);
  fs::create_symlink(link, other);
  fs::create_symlink(folder.path, way);
  const auto files = {link, other, way / "sound.so"};
  for (const fs::path& path : files) CHECK_NOTHROW(dyn::JointRegistry().load(path.string()));
  fs::permissions(open.path, fs::perms::all);
  for (const fs::path& path : files) {
    requireRefused(path.string(), {"'" + open.path.string() + "'", "can be written by"}, dyn::Trust::owner_only);
    CHECK_NOTHROW(dyn::JointRegistry().load(path.string(), dyn::Trust::any));
  }
  for (const fs::path& path : {open.path, way}) {
    dyn::JointRegistry registry;
    registry.loadDirectory(path.string());
    CHECK(registry.jointTypes().empty());
    CHECK(registry.plugins().at(0).problem.find("can be written by") != std::string::npos);
  }
}

TEST_CASE("files and folders of another user are refused", "[trust]") {
  if (geteuid() != 0) DYN_SKIP("only root can give files away");
  const Folder folder, elsewhere;
  const fs::path file = folder.copy("sound.so"), link = elsewhere.path / "link.so";
  fs::create_symlink(file, link);
  for (const fs::path& given : {file, folder.path, elsewhere.path}) {
    REQUIRE(chown(given.c_str(), 12345, 12345) == 0);
    requireRefused(link.string(), {"'" + given.string() + "'", "another user", "12345"}, dyn::Trust::owner_only);
    REQUIRE(chown(given.c_str(), 0, 0) == 0);
  }
  CHECK_NOTHROW(dyn::JointRegistry().load(link.string()));
}

TEST_CASE("a build for a processor that is not of the plugin beside it is refused", "[processor]") {
  const auto lay = [&](const Folder& folder, const std::string& build) {
    for (const fs::path set : {"avx512", "avx2", "baseline", "scalar"}) folder.copy(build, set / "sound.so");
    return folder.copy("sound.so").string();
  };
  const Folder one;
  requireRefused(lay(one, "stale_description.so"), {"sound_slider", "differently", "rebuild"});
  dyn::JointDescription joint;
  joint.name = "j";
  joint.type = "sound_slider";
  dyn::Model model;
  model.addBody("b", 0, joint);
  for (const char* stale : {"stale_sizes.so", "stale_motion.so"}) {
    INFO(stale);
    const Folder folder;
    dyn::JointRegistry registry;
    registry.load(lay(folder, stale));
    CHECK_THROWS_WITH(dyn::compile(model, registry), dyn::test::containing("'j'") && dyn::test::containing("rebuild the plugin"));
  }
  const Folder good;
  dyn::JointRegistry registry;
  registry.load(lay(good, "sound.so"));
  CHECK_NOTHROW(dyn::compile(model, registry));
}

TEST_CASE("folders: empty ones, missing ones, and bad files among good ones") {
  const Folder folder;
  dyn::JointRegistry registry;
  registry.loadDirectory(folder.path.string());
  CHECK(registry.plugins().empty());
  CHECK(registry.searched() == std::vector<std::string>{folder.path.string()});
  registry.loadDirectory((folder.path / "missing").string());
  REQUIRE(registry.plugins().size() == 1);
  CHECK(registry.plugins()[0].problem.find("cannot read the folder") != std::string::npos);

  folder.copy("exports_nothing.so");
  folder.copy("throws_in_constructor.so");
  folder.copy("sound.so");
  std::ofstream(folder.path / "notes.txt") << "not looked at";
  dyn::JointRegistry mixed;
  mixed.loadDirectory(folder.path.string());
  REQUIRE(mixed.plugins().size() == 3);
  CHECK_NOTHROW(mixed.jointType("sound_slider"));
  try {
    mixed.jointType("absent");
    FAIL("found a type that does not exist");
  } catch (const dyn::Error& e) {
    const std::string text = e.what();
    CHECK(e.code() == dyn::ErrorCode::joint_type);
    for (const char* word : {"absent", "exports_nothing.so", "throws_in_constructor.so", "no licence found"})
      CHECK(text.find(word) != std::string::npos);
    CHECK(text.find(folder.path.string()) != std::string::npos);
  }
}
