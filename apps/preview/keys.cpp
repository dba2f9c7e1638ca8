#include "keys.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace raylab {

namespace {

constexpr std::array<std::string_view, kKeyCount> kNames{
    "w", "a", "s",     "d",       "q", "e",     "r",   "f",     "v",      "c",    "b",         "m",  "h",
    "p", "z", "x",     "-",       "=", "space", "tab", "enter", "escape", "home", "backspace", "up", "down",
    "[", "]", "shift", "control", "1", "2",     "3",   "4",     "5",      "6",    "7",         "8",  "9"};

constexpr KeyHelp kHelp[]{
    {"W A S D", "forward, left, back, right"},
    {"Space R / E Q", "up / down"},
    {"Shift / Ctrl", "fast / slow"},
    {"mouse, button held", "look around (M: without a button)"},
    {"wheel", "speed"},
    {"V", "raster or path traced"},
    {"Tab", "orbit around what is under the pointer"},
    {"click", "focus on what is there"},
    {"Up / Down", "focus farther / nearer"},
    {"[ / ]", "aperture smaller / larger"},
    {"F", "focus plane"},
    {"Z / X", "field of view narrower / wider"},
    {"- / =", "path traced picture shown darker / brighter, by half a stop"},
    {"1 ... 9", "accelerator"},
    {"C", "compare: split, difference, disagreement"},
    {"B", "accelerator compared with"},
    {"P", "save the picture, PNG and EXR"},
    {"Home", "all of the scene into view"},
    {"Backspace", "camera as the file has it"},
    {"Enter", "write the camera to the scene file"},
    {"H", "this help"},
    {"Esc", "leave, writing nothing"},
};

}  // namespace

std::optional<Key> parse_key(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto found = std::find(kNames.begin(), kNames.end(), lower);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Key>(found - kNames.begin());
}

std::string_view key_name(Key key) { return kNames[static_cast<std::size_t>(key)]; }

std::span<const KeyHelp> key_help() { return kHelp; }

std::string key_help_text() {
  std::string text;
  for (const KeyHelp& line : kHelp) {
    std::string keys = line.keys;
    keys.resize(std::max<std::size_t>(keys.size() + 1, 22), ' ');
    text += "  " + keys + line.what + "\n";
  }
  return text;
}

}  // namespace raylab
