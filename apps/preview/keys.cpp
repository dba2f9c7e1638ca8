#include "keys.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace raylab {

namespace {

constexpr std::array<std::string_view, kKeyCount> kNames{
    "w",     "a",       "s",      "d",    "q",         "e",      "r",        "f",  "v",    "c", "b",
    "m",     "h",       "p",      "z",    "x",         "u",      "n",        "f5", "-",    "=", "space",
    "tab",   "enter",   "escape", "home", "backspace", "pageup", "pagedown", "up", "down", "[", "]",
    "shift", "control", "1",      "2",    "3",         "4",      "5",        "6",  "7",    "8", "9"};

constexpr KeyHelp kHelp[]{
    {"{w} {a} {s} {d}", "fly forward, left, back, right"},
    {"{space} {r} / {e} {q}", "fly up / down"},
    {"{shift} / {control}", "faster / slower, while held"},
    {"mouse, button held", "look around ({m}: without a button)"},
    {"wheel", "speed of flying"},
    {"{tab}", "orbit around what is under the pointer, and fly again"},
    {"{home}", "all of the scene into view"},
    {"{backspace}", "camera as the file has it"},
    {"{enter}", "write the camera to the scene file"},
    {"{n}", "add the camera to the scene file as a view"},
    {"{pageup} / {pagedown}", "go to the view before / after"},
    {"{z} / {x}", "field of view narrower / wider"},
    {"click", "focus on what is there"},
    {"{up} / {down}", "focus farther / nearer"},
    {"{[} / {]}", "aperture smaller / larger: less / more blur out of focus"},
    {"{f}", "show the plane that is in focus"},
    {"{v}", "quick raster picture, or path traced"},
    {"{-} / {=}", "path traced picture darker / brighter on the screen"},
    {"1 2 3 ...", "trace with the accelerator of that number"},
    {"{c}", "compare two: side by side, difference, where rays disagree"},
    {"{b}", "choose the accelerator to compare with"},
    {"{p}", "save the picture, PNG and EXR"},
    {"{f5}", "read the scene again, as also happens when its files change"},
    {"{u}", "hide all text, and show it again"},
    {"{h}", "this help"},
    {"{escape}", "leave, writing nothing"},
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

std::string plain_key_name(Key key) {
  std::string name(key_name(key));
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

std::string with_key_names(std::string_view text, const std::function<std::string(Key)>& name) {
  std::string named;
  for (std::size_t open = text.find('{'); open != std::string_view::npos; open = text.find('{')) {
    const std::size_t close = text.find('}', open + 2);
    named.append(text.substr(0, open)).append(name(*parse_key(text.substr(open + 1, close - open - 1))));
    text.remove_prefix(close + 1);
  }
  return named.append(text);
}

std::string key_help_text() {
  std::string text;
  for (const KeyHelp& line : kHelp) {
    std::string keys = with_key_names(line.keys, plain_key_name);
    keys.resize(std::max<std::size_t>(keys.size() + 1, 22), ' ');
    text += "  " + keys + with_key_names(line.what, plain_key_name) + "\n";
  }
  return text;
}

}  // namespace raylab
