#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace raylab {

/// Keys that mean something, without the window system's numbers for them.
enum class Key : std::uint8_t {
  w,
  a,
  s,
  d,
  q,
  e,
  r,
  f,
  v,
  c,
  b,
  m,
  h,
  p,
  z,
  x,
  u,
  n,
  f5,
  minus,
  equal,
  space,
  tab,
  enter,
  escape,
  home,
  backspace,
  page_up,
  page_down,
  up,
  down,
  left_bracket,
  right_bracket,
  shift,
  control,
  digit1,
  digit2,
  digit3,
  digit4,
  digit5,
  digit6,
  digit7,
  digit8,
  digit9,
  count,
};
inline constexpr int kKeyCount = static_cast<int>(Key::count);

/// "w", "space", "[", "1": as scripts and the help write it. Any case.
std::optional<Key> parse_key(std::string_view name);
std::string_view key_name(Key key);

/// How a key is called where no keyboard says it: "W", "Space", "[".
std::string plain_key_name(Key key);

/// One line of the help. Keys stand in it as {w} or {space}, by their key_name().
struct KeyHelp {
  const char* keys;
  const char* what;
};
std::span<const KeyHelp> key_help();

/// The text with the keys in it named so.
std::string with_key_names(std::string_view text, const std::function<std::string(Key)>& name);

/// The help as plain text, for --help.
std::string key_help_text();

}  // namespace raylab
