#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "keys.hpp"

namespace raylab {

/// One step of a script: what a hand at the keyboard and the mouse does.
struct ScriptStep {
  enum class Kind : std::uint8_t {
    down,        ///< key goes down
    up,          ///< key comes up
    wait,        ///< `count` frames
    wait_still,  ///< until the picture has all its samples
    mouse,       ///< moves by (x, y) pixels, no button held
    drag,        ///< look: the mouse moves by (x, y) pixels with a button held
    click,       ///< at (x, y) pixels of the window
    point,       ///< the mouse moves to (x, y)
    scroll,      ///< the wheel turns by x
    resize,      ///< the window becomes x by y pixels
    minimise,
    restore,
    screenshot,  ///< of the window, to `file`
    picture,     ///< what P saves, to `file` (PNG or EXR)
    close,       ///< as the window's own button does
  };
  Kind kind;
  Key key = Key::w;
  int count = 0;
  double x = 0.0, y = 0.0;
  std::string file;
  int line = 0;
};

/// Parses a script, one command a line, # starts a comment:
///   key NAME [FRAMES]     down, so many frames (1), up
///   down NAME | up NAME | wait FRAMES | wait still | mouse DX DY | drag DX DY | click X Y | point X Y | scroll N
///   resize WIDTH HEIGHT | minimise | restore | screenshot FILE | picture FILE | close
/// Throws Error (input) with file:line.
std::vector<ScriptStep> parse_script(std::string_view text, const std::string& file);

/// Hands out the steps of a script as frames go by; waiting it does itself.
class ScriptRunner {
 public:
  explicit ScriptRunner(std::vector<ScriptStep> steps) : steps_(std::move(steps)) {}

  /// The next step of this frame, or null when the frame is to be drawn. `still`: whether what is shown will not
  /// change any more by itself. Call until null, once a frame. A screenshot ends its frame.
  const ScriptStep* next(bool still);

  bool finished() const { return at_ == steps_.size() && waiting_ == 0; }

 private:
  std::vector<ScriptStep> steps_;
  std::size_t at_ = 0;
  int waiting_ = 0;  // frames
  bool frame_ends_ = false;
  bool waited_ = false;  // a frame, of a wait until still
};

}  // namespace raylab
