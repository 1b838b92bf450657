// SPDX-License-Identifier: BSD-2-Clause
// Files are read or replaced as a whole or not at all.
#include "support/folder.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <sstream>
#include <thread>
#include <vector>

using namespace dyn;
using namespace dyn::test;
namespace fs = std::filesystem;

namespace {

std::string textOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("a file that is replaced is an ordinary new file, and nothing is left beside it", "[file]") {
  const Folder folder;
  const fs::path path = folder.path / "out";
  const mode_t before = umask(022);
  replaceFile(path, "one");
  replaceFile(path, std::string(1 << 20, 'x'));
  umask(before);
  struct stat s {};
  REQUIRE(stat(path.c_str(), &s) == 0);
  CHECK((s.st_mode & 0777) == 0644);
  CHECK(fs::file_size(path) == 1 << 20);
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
  CHECK_THROWS_WITH(replaceFile(folder.path / "none" / "out", "x"), containing("none/out") && containing("cannot be written"));
  fs::create_directory(folder.path / "full");
  folder.write("full/file", "x");
  CHECK_THROWS_AS(replaceFile(folder.path / "full", "x"), Error);
  CHECK_THROWS_WITH(checkReplaceable(folder.path / "none" / "out"), containing("none/out") && containing("cannot be written"));
  CHECK_THROWS_WITH(checkReplaceable(folder.path / "full"), containing("full") && containing("a folder"));
  checkReplaceable(path);
  CHECK(fs::file_size(path) == 1 << 20);
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 2);
}

TEST_CASE("a link planted where a temporary would be is not written through", "[file]") {
  const Folder folder;
  const std::string victim = folder.write("victim", "mine"), path = (folder.path / "out").string(), part = path + ".part" + std::to_string(getpid());
  fs::create_symlink(victim, part);
  for (int i = 0; i < 1000; ++i) fs::create_symlink(victim, part + "-" + std::to_string(i));
  replaceFile(path, "new");
  CHECK(textOf(victim) == "mine");
  CHECK(textOf(path) == "new");
  CHECK_FALSE(fs::is_symlink(path));
}

TEST_CASE("what is no regular file is written into and stays what it is", "[file]") {
  const Folder folder;
  const std::string pipe = (folder.path / "pipe").string();
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  std::string got;
  checkReplaceable(pipe);
  std::thread reader([&] { got = textOf(pipe); });
  replaceFile(pipe, "through it");
  reader.join();
  CHECK(got == "through it");
  CHECK(fs::is_fifo(pipe));
  CHECK_THROWS_WITH(replaceFile("/dev/full", std::string(10000, 'x')), containing("/dev/full") && containing("No space left"));
  CHECK(fs::is_character_file("/dev/full"));
  replaceFile("/dev/null", "x");
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("links stay links, and the files behind them keep their modes and owners", "[file]") {
  const Folder folder;
  const std::string file = folder.write("file", "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  fs::create_directory(folder.path / "elsewhere");
  const fs::path first = folder.path / "elsewhere" / "first", second = folder.path / "second", dangling = folder.path / "dangling";
  fs::create_symlink("../file", first);
  fs::create_symlink(first, second);
  const bool root = geteuid() == 0;
  if (root) REQUIRE(chown(file.c_str(), 12345, 54321) == 0);
  replaceFile(second, "new");
  CHECK(fs::is_symlink(second));
  CHECK(fs::is_symlink(first));
  CHECK(textOf(file) == "new");
  struct stat s {};
  REQUIRE(stat(file.c_str(), &s) == 0);
  CHECK((s.st_mode & 07777) == 0640);
  if (root) CHECK((s.st_uid == 12345 && s.st_gid == 54321));
  fs::create_symlink("made", dangling);
  replaceFile(dangling, "made");
  CHECK(textOf(folder.path / "made") == "made");
  CHECK(fs::is_symlink(dangling));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 5);
}

TEST_CASE("a file that nobody may write is not replaced, by root either", "[file]") {
  const Folder folder;
  const std::string file = folder.write("file", "old");
  fs::permissions(file, fs::perms::owner_read);
  CHECK_THROWS_WITH(replaceFile(file, "new"), containing("read-only") && containing("chmod"));
  CHECK_THROWS_WITH(checkReplaceable(file), containing("read-only"));
  CHECK(textOf(file) == "old");
}

TEST_CASE("threads that replace one file at once each do, whole", "[file]") {
  const Folder folder;
  const std::string path = (folder.path / "out").string();
  std::vector<std::string> why(4);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < why.size(); ++t)
    threads.emplace_back([&, t] {
      try {
        for (int k = 0; k < 100; ++k) replaceFile(path, std::string(10000, static_cast<char>('a' + t)));
      } catch (const Error& e) {
        why[t] = e.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& error : why) CHECK(error.empty());
  const std::string text = textOf(path);
  REQUIRE(text.size() == 10000);
  CHECK(text == std::string(10000, text[0]));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("a file is read as it is, bytes of every value, and no more of it than is wanted", "[file]") {
  const Folder folder;
  std::string bytes(200000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i % 251);
  const std::string path = folder.write("bytes", bytes);
  CHECK(readFile(path) == bytes);
  CHECK(readFile(path, bytes.size()) == bytes);
  CHECK(readFile(folder.write("empty", "")).empty());
  CHECK_THROWS_WITH(readFile(folder.write("large", std::string((1 << 20) + 1, 'x')), 1 << 20), containing("larger than 1 MB"));
  CHECK_THROWS_WITH(readFile("/dev/zero", 1 << 20), containing("larger than 1 MB"));
  CHECK_THROWS_WITH(readFile((folder.path / "none").string()), containing("none: does not exist"));
  CHECK_THROWS_WITH(readFile(folder.path.string()), containing("folder"));
}
