#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "catch.hpp"
#include "expect_error.hpp"
#include "file_size_limit.hpp"
#include "raylab/core/atomic_file.hpp"
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
