#include "film_info.hpp"

#include <charconv>
#include <cinttypes>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace {

constexpr const char* kFormat = "raylab.filmVersion";
constexpr const char* kFormatVersion = "2";
constexpr const char* kPictureHash = "raylab.pictureHash";
constexpr const char* kSamples = "raylab.samples";
constexpr const char* kWanted = "raylab.samplesWanted";
constexpr const char* kPixels = "raylab.pixels";
constexpr const char* kSeconds = "raylab.seconds";
constexpr const char* kHeaderHash = "raylab.headerHash";
const std::string kSetting = "raylab.setting.";

std::string hex(std::uint64_t value) { return format("%016" PRIx64, value); }

template <class Number>
bool take_number(std::string_view& text, Number& number) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  return error == std::errc();
}

/// "0:16 32:48", in order and apart.
bool parse_ranges(std::string_view text, std::vector<SampleRange>& ranges) {
  while (true) {
    SampleRange range;
    if (!take_number(text, range.first) || !text.starts_with(':')) return false;
    text.remove_prefix(1);
    if (!take_number(text, range.end) || range.first >= range.end) return false;
    if (!ranges.empty() && range.first < ranges.back().end) return false;
    ranges.push_back(range);
    if (text.empty()) return true;
    if (!text.starts_with(' ')) return false;
    text.remove_prefix(1);
  }
}

}  // namespace

std::string to_string(const SampleRange& range) {
  return std::to_string(range.first) + ":" + std::to_string(range.end);
}

std::uint64_t picture_hash(const std::map<std::string, std::string>& settings) { return detail::hash_of(settings); }

std::string settings_difference(const std::map<std::string, std::string>& a, const std::string& name_a,
                                const std::map<std::string, std::string>& b, const std::string& name_b) {
  std::map<std::string, std::string> all = a;
  all.insert(b.begin(), b.end());
  const auto value = [](const auto& settings, const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? std::string("not said") : found->second;
  };
  std::string text;
  for (const auto& [name, ignored] : all) {
    const std::string in_a = value(a, name), in_b = value(b, name);
    if (in_a == in_b) continue;
    if (!text.empty()) text += "; ";
    text += format("%s is %s %s and %s %s", name.c_str(), in_a.c_str(), name_a.c_str(), in_b.c_str(), name_b.c_str());
  }
  return text;
}

namespace detail {

std::uint64_t hash_of(const std::map<std::string, std::string>& texts) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](const std::string& text) {
    for (const char c : text + '\0') hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  };
  for (const auto& [name, value] : texts) {
    add(name);
    add(value);
  }
  return hash;
}

Attributes attributes_of(const FilmInfo& info, int width, int height) {
  Attributes attributes{{kFormat, kFormatVersion},
                        {kPictureHash, hex(picture_hash(info.settings))},
                        {kWanted, std::to_string(info.wanted)},
                        {kPixels, std::to_string(info.pixels)},
                        {kSeconds, format("%.17g", info.seconds)}};
  std::string& samples = attributes[kSamples];
  for (const SampleRange& range : info.ranges) {
    if (!samples.empty()) samples += ' ';
    samples += to_string(range);
  }
  for (const auto& [name, value] : info.settings) attributes[kSetting + name] = value;
  Attributes hashed = attributes;
  hashed["size"] = std::to_string(width) + "x" + std::to_string(height);
  attributes[kHeaderHash] = hex(hash_of(hashed));
  return attributes;
}

void check_version(const Attributes& attributes, const std::filesystem::path& file) {
  const auto found = attributes.find(kFormat);
  const std::string version = found == attributes.end() ? "" : found->second;
  if (version == kFormatVersion) return;
  throw Error(ErrorKind::input, file.string(),
              "its film is of format version " + version + ", and this program reads " + kFormatVersion);
}

FilmInfo info_of(const Attributes& attributes, int width, int height, const std::filesystem::path& file) {
  FilmInfo info;
  const auto text = [&](const char* name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? std::string_view() : std::string_view(found->second);
  };
  for (const auto& [name, value] : attributes) {
    if (name.starts_with(kSetting)) info.settings[name.substr(kSetting.size())] = value;
  }
  std::string_view wanted = text(kWanted), pixels = text(kPixels), seconds = text(kSeconds);
  const bool is_readable = parse_ranges(text(kSamples), info.ranges) && take_number(wanted, info.wanted) &&
                           take_number(pixels, info.pixels) && take_number(seconds, info.seconds);
  if (!is_readable || attributes_of(info, width, height) != attributes) {
    throw Error(ErrorKind::input, file.string(), "the header of its film is damaged");
  }
  return info;
}

}  // namespace detail

}  // namespace raylab
