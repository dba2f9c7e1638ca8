#include "script.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "raylab/core/error.hpp"

namespace raylab {

namespace {

using Kind = ScriptStep::Kind;

struct Command {
  const char* name;
  Kind kind;
  enum class Takes { nothing, key, frames, one, two, size, file } takes;
};
using Takes = Command::Takes;

constexpr Command kCommands[]{
    {"down", Kind::down, Takes::key},           {"up", Kind::up, Takes::key},
    {"wait", Kind::wait, Takes::frames},        {"mouse", Kind::mouse, Takes::two},
    {"drag", Kind::drag, Takes::two},           {"click", Kind::click, Takes::two},
    {"point", Kind::point, Takes::two},         {"scroll", Kind::scroll, Takes::one},
    {"resize", Kind::resize, Takes::size},      {"minimise", Kind::minimise, Takes::nothing},
    {"restore", Kind::restore, Takes::nothing}, {"screenshot", Kind::screenshot, Takes::file},
    {"picture", Kind::picture, Takes::file},    {"close", Kind::close, Takes::nothing},
};

constexpr int kMostFrames = 1 << 20;

/// Reads the words of one line.
class Line {
 public:
  Line(const std::string& text, std::string location) : words_(text), location_(std::move(location)) {}

  [[noreturn]] void fail(const std::string& message) const { throw Error(ErrorKind::input, location_, message); }

  bool word(std::string& out) { return static_cast<bool>(words_ >> out); }

  std::string need(const char* what) {
    std::string found;
    if (!word(found)) fail(std::string("expected ") + what);
    return found;
  }
  Key key() {
    const std::string name = need("a key");
    const auto key = parse_key(name);
    if (!key) fail("found \"" + name + "\", expected a key such as w, space, enter or 1");
    return *key;
  }
  double number() {
    const std::string text = need("a number");
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value)) fail("found \"" + text + "\", expected a number");
    return value;
  }
  int frames(const std::string& text) const {
    char* end = nullptr;
    const long value = std::strtol(text.c_str(), &end, 10);
    if (*end != '\0' || value < 1 || value > kMostFrames) {
      fail("found \"" + text + "\", expected a number of frames, 1 or more");
    }
    return static_cast<int>(value);
  }
  void finish() {
    std::string more;
    if (word(more)) fail("found \"" + more + "\", expected the end of the line");
  }

 private:
  std::istringstream words_;
  std::string location_;
};

void parse_line(Line& line, int number, std::vector<ScriptStep>& steps) {
  std::string name;
  if (!line.word(name)) return;
  ScriptStep step{};
  step.line = number;
  const auto add = [&](Kind kind) {
    step.kind = kind;
    steps.push_back(step);
  };
  if (name == "key") {
    step.key = line.key();
    std::string frames = "1";
    line.word(frames);
    step.count = line.frames(frames);
    add(Kind::down);
    add(Kind::wait);
    add(Kind::up);
    return;
  }
  for (const Command& command : kCommands) {
    if (name != command.name) continue;
    step.kind = command.kind;
    switch (command.takes) {
      case Takes::nothing:
        break;
      case Takes::key:
        step.key = line.key();
        break;
      case Takes::frames: {
        const std::string frames = line.need("a number of frames, or still");
        if (frames == "still")
          step.kind = Kind::wait_still;
        else
          step.count = line.frames(frames);
        break;
      }
      case Takes::one:
        step.x = line.number();
        break;
      case Takes::size:
      case Takes::two:
        step.x = line.number();
        step.y = line.number();
        if (command.takes == Takes::size &&
            !(step.x >= 1.0 && step.y >= 1.0 && step.x <= 16384.0 && step.y <= 16384.0)) {
          line.fail("expected a width and a height from 1 to 16384 pixels");
        }
        break;
      case Takes::file:
        step.file = line.need("a file");
        break;
    }
    steps.push_back(step);
    return;
  }
  line.fail("found \"" + name +
            "\", expected key, down, up, wait, mouse, drag, click, point, scroll, resize, minimise, "
            "restore, screenshot, picture or close");
}

}  // namespace

std::vector<ScriptStep> parse_script(std::string_view text, const std::string& file) {
  std::vector<ScriptStep> steps;
  std::istringstream lines{std::string(text)};
  std::string content;
  for (int number = 1; std::getline(lines, content); ++number) {
    Line line(content.substr(0, content.find('#')), file + ":" + std::to_string(number));
    parse_line(line, number, steps);
    line.finish();
  }
  return steps;
}

const ScriptStep* ScriptRunner::next(bool still) {
  if (std::exchange(frame_ends_, false)) return nullptr;
  if (waiting_ > 0) {
    --waiting_;
    return nullptr;
  }
  if (at_ == steps_.size()) return nullptr;
  const ScriptStep& step = steps_[at_];
  if (step.kind == Kind::wait_still) {
    // What changed in this very frame has not been asked for yet: one frame passes in any case.
    if (waited_ && still) {
      waited_ = false;
      ++at_;
      return next(still);
    }
    waited_ = true;
    return nullptr;
  }
  ++at_;
  if (step.kind == Kind::wait) {
    waiting_ = step.count - 1;
    return nullptr;
  }
  frame_ends_ = step.kind == Kind::screenshot || step.kind == Kind::picture;
  return &step;
}

}  // namespace raylab
