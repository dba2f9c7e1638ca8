#include <stdlib.h>

#include <optional>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/core/scratch_folder.hpp"
#include "temp_folder.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

TEST_CASE("a scratch folder is new, empty and its owner's alone, and goes with what is in it", "[unit][core]") {
  std::optional<ScratchFolder> first(std::in_place, "raylab-test");
  const ScratchFolder second("raylab-test");
  const fs::path path = first->path();
  CHECK(path != second.path());
  CHECK(path.filename().string().rfind("raylab-test-", 0) == 0);
  CHECK(fs::is_empty(path));
  CHECK((fs::status(path).permissions() & fs::perms::all) == fs::perms::owner_all);
  write_text(*first / "file", "text");
  fs::create_directory(*first / "folder");
  first.reset();
  CHECK_FALSE(fs::exists(path));
  CHECK(fs::exists(second.path()));
}

TEST_CASE("a scratch folder that cannot be made is an output error that says why", "[unit][core]") {
  const char* before = getenv("TMPDIR");
  const std::optional<std::string> kept = before == nullptr ? std::nullopt : std::optional<std::string>(before);
  setenv("TMPDIR", "/nowhere", 1);
  expect_error(ErrorKind::output, "the folder of temporary files (TMPDIR)", {"No such file"},
               [] { ScratchFolder folder("raylab-test"); });
  setenv("TMPDIR", "/proc", 1);
  expect_error(ErrorKind::output, "/proc", {"no folder can be made in it"},
               [] { ScratchFolder folder("raylab-test"); });
  if (kept)
    setenv("TMPDIR", kept->c_str(), 1);
  else
    unsetenv("TMPDIR");
}
