// The programs while each call that writes, and allocations, fail in turn, as SQLite is tested: what is there is whole,
// old or new, and what went wrong is said.
#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "raylab/image/film_file.hpp"
#include "raylab/measure/results.hpp"
#include "small_scene.hpp"

#ifdef RAYLAB_FAILING_CALLS

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kBefore = "what was here before";

/// A command whose files, all of them in one folder, were there before.
struct Command {
  std::string program;  ///< raylab-render, …
  std::vector<std::string> arguments;
  std::vector<fs::path> files;
};

Film read_film(const fs::path& file) {
  FilmFile opened(file);
  Film film(opened.width(), opened.height());
  opened.add_to(film);
  return film;
}

/// Throws where the file is not what a program writes, whole.
void check_whole(const fs::path& file) {
  const std::string ending = file.extension();
  if (ending == ".exr") {
    (void)read_exr(file);
    if (FilmFile::is_one(file)) (void)read_film(file);
  } else if (ending == ".png") {
    (void)read_image8(file);
  } else if (ending == ".json") {
    if (nlohmann::json::parse(read_text(file)).empty()) throw std::runtime_error("is empty");
  } else {
    const std::string text = read_text(file);
    if (text.empty() || text.back() != '\n') throw std::runtime_error("ends early: " + file.string());
  }
}

struct FailingCalls : TempFolder {
  fs::path files = *this / "files";    ///< calls that concern these fail
  fs::path report = *this / "report";  ///< see failing_calls.cpp
  fs::path scene = *this / "ball.toml";
  FailingCalls() {
    fs::create_directory(files);
    fs::create_directory(*this / "tmp");
    write_text(scene, kBall);
  }

  ProgramResult run(const Command& command, std::vector<std::string> settings) const {
    fs::remove(report);
    settings.insert(settings.end(), {"LD_PRELOAD=" RAYLAB_FAILING_CALLS, "FAIL_UNDER=" + files.string(),
                                     "FAIL_REPORT=" + report.string(), "TMPDIR=" + (*this / "tmp").string(),
                                     RAYLAB_BINARY_DIR "/" + command.program});
    settings.insert(settings.end(), command.arguments.begin(), command.arguments.end());
    return run_program("/usr/bin/env", settings);
  }

  /// Runs the command with these settings and the files as they were before. Whether a call has failed.
  bool check(const Command& command, const std::string& setting, const std::string& value, bool onwards,
             const std::function<void()>& prepare) const {
    prepare();
    std::map<fs::path, std::string> before;
    for (const fs::path& file : command.files) before[file] = fs::exists(file) ? read_text(file) : "";
    const ProgramResult result = run(command, {setting + "=" + value, onwards ? "FAIL_ONWARDS=1" : "FAIL_ONWARDS=0"});
    if (!fs::exists(report)) return false;
    INFO(command.program << " " << command.arguments.front() << ", " << setting << "=" << value << ", "
                         << read_text(report) << "exit code " << result.exit_code << ", " << result.err);
    CHECK(result.exit_code <= 4);
    if (result.exit_code != 0) {
      // Lines, each by the program; the last says what ended it.
      std::istringstream lines(result.err);
      std::string line, last;
      for (; std::getline(lines, line); last = line) CHECK(line.starts_with(command.program + ": "));
      CHECK(last.size() > command.program.size() + 2);
      CHECK_FALSE(last.starts_with(command.program + ": warning"));
      CHECK(result.err.ends_with("\n"));
    }
    for (const fs::path& file : command.files) {
      const bool is_old = fs::exists(file) ? read_text(file) == before[file] : before[file].empty();
      if (is_old && result.exit_code != 0) continue;
      INFO(file);
      CHECK_NOTHROW(check_whole(file));
      CHECK_FALSE(is_old);
    }
    for (const auto& folder : {files, *this / "tmp"}) {
      for (const auto& entry : fs::directory_iterator(folder)) {
        INFO(entry.path());
        CHECK_FALSE(entry.path().filename().string().starts_with(".raylab"));
        if (entry.path().string().ends_with(".checkpoint.exr")) CHECK_NOTHROW(check_whole(entry.path()));
      }
    }
    return true;
  }

  /// Every call in turn, and all from each one on.
  void check_calls(const Command& command, const std::function<void()>& prepare) const {
    for (const bool onwards : {false, true}) {
      int n = 1;
      while (check(command, "FAIL_AT", std::to_string(n), onwards, prepare)) ++n;
      CHECK(n > 5);
    }
  }

  /// Some of the allocations, of which there are thousands.
  void check_allocations(const Command& command, const std::function<void()>& prepare) const {
    int n = 1;
    while (check(command, "FAIL_ALLOCATION", std::to_string(n), false, prepare)) n += 1 + n / 12;
    CHECK(n > 500);
  }

  /// Files of pictures, there before.
  std::function<void()> with_old(const Command& command) const {
    return [this, files = command.files] {
      for (const auto& entry : fs::directory_iterator(this->files)) fs::remove_all(entry.path());
      for (const fs::path& file : files) write_text(file, kBefore);
    };
  }
};

Command render(const FailingCalls& calls, const std::vector<std::string>& more = {}) {
  const fs::path exr = calls.files / "a.exr", png = calls.files / "a.png", stats = calls.files / "s.json";
  Command command{"raylab-render",
                  {calls.scene.string(), "-o", exr.string(), "-o", png.string(), "--film", "--stats", stats.string(),
                   "--threads", "1"},
                  {exr, png, stats}};
  command.arguments.insert(command.arguments.end(), more.begin(), more.end());
  return command;
}

Command merge(const FailingCalls& calls) {
  std::vector<std::string> arguments{"merge", "-o", (calls.files / "m.exr").string()};
  for (const std::string samples : {"0:2", "2:4"}) {
    arguments.push_back((calls / ("part" + samples + ".exr")).string());
    REQUIRE(raylab_render({calls.scene.string(), "-o", arguments.back(), "--samples", samples}).exit_code == 0);
  }
  return {"raylab-image", arguments, {calls.files / "m.exr"}};
}

/// Into a folder that has rows of another accelerator.
struct Bench {
  Command command;
  fs::path old;
  std::function<void()> prepare;

  explicit Bench(const FailingCalls& calls) : command(of("list", calls, calls.files)), old(calls / "old") {
    const Command before = of("bvh", calls, old);
    REQUIRE(run_program(RAYLAB_BINARY_DIR "/raylab-bench", before.arguments).exit_code == 0);
    prepare = [this] {
      for (const fs::path& file : command.files) {
        fs::copy(old / file.filename(), file, fs::copy_options::overwrite_existing);
      }
    };
  }
  static Command of(const char* accel, const FailingCalls& calls, const fs::path& folder) {
    return {"raylab-bench",
            {"rays", calls.scene.string(), "--accel", accel, "--intersector", "fast", "--rays", "50", "--checked", "5",
             "--repeats", "1", "--out", folder.string()},
            {folder / "results.json", folder / "results.csv"}};
  }
};

}  // namespace

TEST_CASE("each call that fails leaves pictures, films and figures whole, old or new, and is told", "[cli][faults]") {
  const FailingCalls calls;
  const Command command = render(calls);
  calls.check_calls(command, calls.with_old(command));
}

TEST_CASE("each call that fails while a checkpoint is written is told, and the picture comes", "[cli][faults]") {
  const FailingCalls calls;
  const fs::path output = calls.files / "a.exr";
  const Command command{"raylab-render",
                        {calls.scene.string(), "-o", output.string(), "--spp", "20000", "--checkpoint-every", "0.001s",
                         "--progress", "none"},
                        {output}};
  for (int n = 5; n < 30; ++n) calls.check(command, "FAIL_AT", std::to_string(n), false, calls.with_old(command));
}

TEST_CASE("a render that cannot be written on a disk that stays full is kept elsewhere", "[cli][faults]") {
  const FailingCalls calls;
  const Command command = render(calls);
  calls.with_old(command)();
  const ProgramResult result = calls.run(command, {"FAIL_AT=15", "FAIL_ONWARDS=1"});
  const fs::path kept = calls / "tmp/a.exr.checkpoint.exr";
  INFO(result.err);
  CHECK(result.exit_code == 4);
  CHECK(result.err.find("the render is kept in " + kept.string()) != std::string::npos);
  REQUIRE(raylab_render({calls.scene.string(), "-o", (calls / "whole.exr").string(), "--film"}).exit_code == 0);
  CHECK(read_film(kept) == read_film(calls / "whole.exr"));
}

TEST_CASE("each call that fails while a scene is written leaves it whole or not there", "[cli][faults]") {
  const FailingCalls calls;
  const std::string model = (calls / "a.obj").string();
  const fs::path scene = calls.files / "a.toml", output = calls.files / "a.png";
  write_text(model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Command command{"raylab-render",
                        {model, "-o", output.string(), "--width", "8", "--spp", "1", "--write-scene", scene.string()},
                        {scene, output}};
  calls.check_calls(command, [&] {
    calls.with_old(command)();
    fs::remove(scene);  // that which is there is never written over
  });
}

TEST_CASE("each call that fails in raylab-image leaves its picture whole, old or new, and is told", "[cli][faults]") {
  const FailingCalls calls;
  const Command merged = merge(calls);
  calls.check_calls(merged, calls.with_old(merged));
  const std::string part = (calls / "part0:2.exr").string(), other = (calls / "part2:4.exr").string();
  const Command converted{"raylab-image", {"convert", part, (calls.files / "c.png").string()}, {calls.files / "c.png"}};
  calls.check_calls(converted, calls.with_old(converted));
  const Command compared{
      "raylab-image", {"diff", part, other, "-o", (calls.files / "d.exr").string()}, {calls.files / "d.exr"}};
  calls.check_calls(compared, calls.with_old(compared));
}

TEST_CASE("each call that fails in raylab-bench leaves the rows of before and is told", "[cli][faults]") {
  const FailingCalls calls;
  const Bench bench(calls);
  const std::size_t rows_before = read_results(bench.old).rows.size();
  calls.check_calls(bench.command, bench.prepare);
  CHECK(read_results(calls.files).rows.size() == 2 * rows_before);
  bench.prepare();
  CHECK(calls.run(bench.command, {"FAIL_AT=25"}).exit_code == 4);
  CHECK(read_results(calls.files).rows.size() >= rows_before);
}

TEST_CASE("allocations that fail end a program in a line, and leave files whole, old or new", "[cli][faults]") {
  const FailingCalls calls;
  const Command rendered = render(calls), merged = merge(calls);
  calls.check_allocations(rendered, calls.with_old(rendered));
  calls.check_allocations(merged, calls.with_old(merged));
  const Bench bench(calls);
  calls.check_allocations(bench.command, bench.prepare);
}

TEST_CASE("a render whose memory runs out is kept, and gone on with to the same bits", "[cli][faults]") {
  const FailingCalls calls;
  const Command command = render(calls, {"--spp", "2000", "--tile-size", "1"});
  const std::string checkpoint = (calls.files / "a.exr.checkpoint.exr").string();
  const auto run_out = [&] {
    // Somewhere among the thousands of a render.
    for (int n = 2000;; n += 500) {
      const ProgramResult result = calls.run(command, {"FAIL_ALLOCATION=" + std::to_string(n)});
      if (fs::exists(checkpoint) || result.exit_code == 0) return result;
    }
  };
  const ProgramResult result = run_out();
  INFO(result.err);
  CHECK(result.exit_code == 1);
  CHECK(result.err == "raylab-render: warning: the render is kept in " + checkpoint +
                          ": --resume goes on from it\nraylab-render: out of memory\n");
  CHECK_FALSE(fs::exists(command.files.front()));
  Command resumed = command;
  resumed.arguments.push_back("--resume");
  const ProgramResult second = calls.run(resumed, {});
  CHECK(second.exit_code == 0);
  CHECK(second.out.find("resumed    " + checkpoint) != std::string::npos);
  const Film film = read_film(command.files.front());
  REQUIRE(calls.run(command, {}).exit_code == 0);
  CHECK(read_film(command.files.front()) == film);
}

#endif
