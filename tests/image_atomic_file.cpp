#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>

#include "catch.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/image/image_file.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("an atomic file appears when committed, and not before", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  AtomicFile output(file);
  output.stream() << "new";
  output.stream().flush();
  CHECK_FALSE(fs::exists(file));
  output.commit();
  CHECK(read_text(file) == "new");
  CHECK(folder.entries() == 1);
}

TEST_CASE("an atomic file that is not committed leaves the old one, and nothing else", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  write_text(file, "old");
  {
    AtomicFile output(file);
    output.stream() << "new";
  }
  CHECK(read_text(file) == "old");
  CHECK(folder.entries() == 1);
  AtomicFile output(file);
  output.stream() << "new";
  output.commit();
  CHECK(read_text(file) == "new");
  CHECK(folder.entries() == 1);
}

TEST_CASE("an atomic file refuses to commit what could not be written", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  write_text(file, "old");
  AtomicFile output(file);
  output.stream() << "half of it";
  output.stream().setstate(std::ios::badbit);  // as a full disk would
  expect_error(ErrorKind::output, file.string(), {"cannot be written"}, [&] { output.commit(); });
  CHECK(read_text(file) == "old");
}

TEST_CASE("a full disk is reported with the system's reason, and the old file stays", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  write_text(file, "old");
  const auto expect = [&](std::size_t size, const char* reason) {
    const FileSizeLimit limit(5);
    AtomicFile output(file);
    output.stream() << std::string(size, 'x');
    expect_error(ErrorKind::output, file.string(), {"cannot be written", reason}, [&] { output.commit(); });
  };
  expect(10, "File too large");
  expect(100000, "is the disk full?");  // failed before the commit: the reason is lost
  CHECK(read_text(file) == "old");
  CHECK(folder.entries() == 1);
}

TEST_CASE("a pipe is written to and stays a pipe", "[unit][core]") {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(reader >= 0);
  AtomicFile output(pipe);
  output.stream() << "text";
  output.commit();
  char text[5] = {};
  CHECK(read(reader, text, 4) == 4);
  close(reader);
  CHECK(text == std::string("text"));
  CHECK(fs::is_fifo(pipe));
  CHECK(folder.entries() == 1);
}

TEST_CASE("a pipe that no one reads is an error and no wait without end", "[unit][core]") {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe.png";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  expect_error(ErrorKind::output, pipe.string(), {"cannot be written"}, [&] { AtomicFile output(pipe); });
  check_writable(pipe);  // a reader may come
  expect_error(ErrorKind::output, pipe.string(), {"is a pipe"}, [&] { check_writable_image(pipe); });
}

TEST_CASE("an atomic file keeps the permissions of the one it replaces", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  write_text(file, "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  AtomicFile output(file);
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    CHECK(entry.status().permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  }
  output.stream() << "new";
  output.commit();
  CHECK(read_text(file) == "new");
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("an atomic file is put where a dangling link says, and the link stays", "[unit][core]") {
  const TempFolder folder;
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink("elsewhere/target.txt", folder / "second.txt");
  fs::create_symlink("second.txt", folder / "first.txt");
  AtomicFile output(folder / "first.txt");
  output.stream() << "new";
  output.commit();
  CHECK(fs::is_symlink(folder / "first.txt"));
  CHECK(fs::is_symlink(folder / "second.txt"));
  CHECK(read_text(folder / "elsewhere/target.txt") == "new");
  fs::create_symlink("nowhere/target.txt", folder / "third.txt");
  expect_error(ErrorKind::output, (folder / "third.txt").string(), {"No such file"},
               [&] { AtomicFile lost(folder / "third.txt"); });
}

TEST_CASE("what killed processes left is removed, and what is in use is not", "[unit][core]") {
  const TempFolder folder;
  const fs::path left = folder / ".raylab-1234-0.tmp", fresh = folder / ".raylab-1234-1.tmp";
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  AtomicFile in_use(folder / "a.txt");
  for (const auto& entry : fs::directory_iterator(folder.path())) fs::last_write_time(entry.path(), old);
  write_text(left, "left");
  fs::last_write_time(left, old);
  write_text(fresh, "fresh");
  write_text(folder / "raylab.tmp", "another's");
  fs::last_write_time(folder / "raylab.tmp", old);
  AtomicFile other(folder / "b.txt");
  CHECK_FALSE(fs::exists(left));
  CHECK(fs::exists(fresh));
  CHECK(fs::exists(folder / "raylab.tmp"));
  in_use.commit();
  other.commit();
  CHECK(fs::exists(folder / "a.txt"));
}

TEST_CASE("a temporary file takes no name that is in use", "[unit][core]") {
  const TempFolder folder;
  constexpr int kNames = 1000;  // more than this process has made so far
  for (int i = 0; i < kNames; ++i) {
    write_text(folder / (".raylab-" + std::to_string(getpid()) + "-" + std::to_string(i) + ".tmp"), "another's");
  }
  AtomicFile output(folder / "a.txt");
  output.stream() << "new";
  output.commit();
  CHECK(folder.entries() == kNames + 1);
  int kept = 0;
  for (const auto& entry : fs::directory_iterator(folder / ".")) kept += read_text(entry.path()) == "another's";
  CHECK(kept == kNames);
}

TEST_CASE("an atomic file follows links", "[unit][core]") {
  const TempFolder folder;
  fs::create_directory(folder / "elsewhere");
  write_text(folder / "elsewhere/target.txt", "old");
  fs::create_symlink("elsewhere/target.txt", folder / "link.txt");
  AtomicFile output(folder / "link.txt");
  output.stream() << "new";
  output.commit();
  CHECK(fs::is_symlink(folder / "link.txt"));
  CHECK(read_text(folder / "elsewhere/target.txt") == "new");
}

TEST_CASE("an atomic file may have the longest name there is", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / std::string(255, 'x');
  AtomicFile output(file);
  output.stream() << "new";
  output.commit();
  CHECK(read_text(file) == "new");
}

TEST_CASE("two writers of one file do not mix", "[unit][core]") {
  const TempFolder folder;
  const fs::path file = folder / "a.txt";
  AtomicFile first(file);
  AtomicFile second(file);
  first.stream() << "first";
  second.stream() << "second";
  second.commit();
  CHECK(read_text(file) == "second");
  first.commit();
  CHECK(read_text(file) == "first");
  CHECK(folder.entries() == 1);
}

TEST_CASE("what cannot be written is found out without leaving a trace", "[unit][core]") {
  const TempFolder folder;
  write_text(folder / "file", "");
  fs::create_directory(folder / "folder");
  const auto expect = [](const fs::path& file, const char* reason) {
    expect_error(ErrorKind::output, file.string(), {"cannot be written", reason}, [&] { check_writable(file); });
    expect_error(ErrorKind::output, file.string(), {"cannot be written", reason}, [&] { AtomicFile f(file); });
  };
  expect(folder / "missing/a.txt", "No such file");
  expect(folder / "file/a.txt", "Not a directory");
  expect(folder / "folder", "Is a directory");
  expect(folder / "", "Is a directory");
  expect("", "No such file");
  if (geteuid() != 0) {  // root may write anywhere
    fs::permissions(folder / "folder", fs::perms::owner_read | fs::perms::owner_exec);
    expect(folder / "folder/a.txt", "Permission denied");
  }
  check_writable(folder / "a.txt");
  check_writable(folder / "file");
  CHECK(folder.entries() == 2);
}
