// Scripts in place of a hand at the keys.
#include "../catch.hpp"
#include "../expect_error.hpp"
#include "script.hpp"

using namespace raylab;
using namespace raylab::test;

TEST_CASE("scripts are parsed line by line", "[unit][preview]") {
  const auto steps = parse_script("# c\nkey W 3\n\n drag -10 2.5 # more\nscreenshot a.png\nwait still\n", "s");
  REQUIRE(steps.size() == 6);
  CHECK(steps[0].kind == ScriptStep::Kind::down);
  CHECK(steps[0].key == Key::w);
  CHECK(steps[1].count == 3);
  CHECK(steps[2].kind == ScriptStep::Kind::up);
  CHECK(steps[3].x == -10.0);
  CHECK(steps[3].line == 4);
  CHECK(steps[4].file == "a.png");
  CHECK(steps[5].kind == ScriptStep::Kind::wait_still);
  for (const char* bad : {"jump", "key hyper", "wait", "wait 0", "wait soon", "drag 1", "mouse 1", "drag 1 x",
                          "close now", "resize 0 10", "screenshot", "key w 1 2"}) {
    INFO(bad);
    expect_error(ErrorKind::input, "s:2", {}, [&] { parse_script(std::string("wait 1\n") + bad, "s"); });
  }
}

TEST_CASE("a script's steps come in their frames", "[unit][preview]") {
  ScriptRunner runner(parse_script("key w 2\nwait still\nscreenshot a\nclose", "s"));
  using Kind = ScriptStep::Kind;
  CHECK(runner.next(false)->kind == Kind::down);
  CHECK(runner.next(false) == nullptr);
  CHECK(runner.next(false) == nullptr);
  CHECK(runner.next(true)->kind == Kind::up);
  CHECK(runner.next(true) == nullptr);  // still, but of what was before
  CHECK(runner.next(false) == nullptr);
  CHECK(runner.next(true)->kind == Kind::screenshot);
  CHECK(runner.next(true) == nullptr);  // the frame that is shot
  CHECK_FALSE(runner.finished());
  CHECK(runner.next(true)->kind == Kind::close);
  CHECK(runner.finished());
}
