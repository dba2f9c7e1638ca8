#include "mtl_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "file_bytes.hpp"
#include "message_text.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  constexpr std::string_view space = " \t";
  for (std::size_t at = text.find_first_not_of(space); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(space, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(space, end);
  }
  return words;
}

/// Words before a comment, on lines that hold no names.
std::vector<std::string_view> values_of(std::string_view text) { return words_of(text.substr(0, text.find('#'))); }

std::optional<float> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;  // what is too small for a float becomes 0
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const float rounded = static_cast<float>(value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(rounded)) return std::nullopt;
  return rounded;
}

/// How many values the options of a texture map take: at most, for those with a variable number.
int option_values(std::string_view option) {
  constexpr std::string_view one[] = {"-blendu", "-blendv",  "-boost", "-texres", "-clamp",
                                      "-bm",     "-imfchan", "-type",  "-cc"};
  constexpr std::string_view up_to_three[] = {"-o", "-s", "-t"};
  if (std::find(std::begin(one), std::end(one), option) != std::end(one)) return 1;
  if (std::find(std::begin(up_to_three), std::end(up_to_three), option) != std::end(up_to_three)) return 3;
  return option == "-mm" ? 2 : 0;
}

class MtlReader {
 public:
  MtlReader(const std::filesystem::path& file, std::vector<std::string>& warnings)
      : file_(file.string()), warnings_(warnings) {}

  std::vector<MtlMaterial> read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
      statement(trimmed(text.substr(0, end)));
      text.remove_prefix(end);
      text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(text.size(), 1));
    }
    for (MtlMaterial& material : materials_) check_index(material);
    return std::move(materials_);
  }

 private:
  std::string location() const { return file_ + ":" + std::to_string(line_); }

  [[noreturn]] void fail(std::string_view found, const std::string& expected) const {
    throw Error(ErrorKind::input, location(), "found " + in_quotes(found) + ", expected " + expected);
  }

  void warn_once(const std::string& kind, const std::string& message) {
    if (warned_.insert(kind).second) warnings_.push_back(location() + ": " + message);
  }

  void statement(std::string_view line) {
    if (line.empty()) return;
    if (line[0] == '#') return comment(line);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    const std::string keyword(line.substr(0, end));
    const std::string_view rest = trimmed(line.substr(end));
    if (keyword == "newmtl") {
      new_material(std::string(rest));
    } else if (materials_.empty()) {
      warn_once(keyword, in_quotes(keyword) + " before the first newmtl is left out");
    } else if (!skipping_) {
      property(materials_.back(), keyword, rest);
    }
  }

  /// "# Blender MTL File: 'desk.blend'", and from 3.1 on "# Blender 3.1.0 MTL File: 'desk.blend'".
  void comment(std::string_view line) {
    constexpr std::string_view blender = "# Blender";
    if (!materials_.empty() || !line.starts_with(blender)) return;
    const std::string_view rest = trimmed(line.substr(blender.size()));
    const bool has_number = !rest.empty() && rest[0] >= '3' && rest[0] <= '9' && !rest.starts_with("3D");
    writer_ = has_number ? MtlWriter::blender_with_number : MtlWriter::blender;
  }

  void new_material(std::string name) {
    if (name.empty()) fail("newmtl", "a name after newmtl");
    const auto [same, is_new] = line_of_.try_emplace(name, line_);
    skipping_ = !is_new;
    if (skipping_) {
      warnings_.push_back(location() + ": material " + in_quotes(name) + " is left out: " + file_ + ":" +
                          std::to_string(same->second) + " has that name");
      return;
    }
    materials_.emplace_back();
    materials_.back().name = std::move(name);
    materials_.back().location = location();
    materials_.back().writer = writer_;
  }

  void check_index(MtlMaterial& material) {
    if (!material.ni || *material.ni > 0.0f) return;
    if (material.is_plain()) {
      throw Error(ErrorKind::input, material.ni_place,
                  "found " + in_quotes(number_text(*material.ni)) + ", expected an index of refraction above 0");
    }
    if (warned_.insert("Ni 0").second) {
      warnings_.push_back(material.ni_place + ": Ni " + number_text(*material.ni) +
                          " is no index of refraction and left out");
    }
    material.ni.reset();
  }

  void property(MtlMaterial& material, const std::string& keyword, std::string_view rest) {
    if (keyword == "Kd") {
      material.kd = color(keyword, rest);
    } else if (keyword == "Ks") {
      material.ks = color(keyword, rest);
    } else if (keyword == "Ke") {
      material.ke = color(keyword, rest);
    } else if (keyword == "Ns") {
      material.ns = number(rest);
    } else if (keyword == "Ni") {
      material.ni = number(rest);
      material.ni_place = location();
    } else if (keyword == "illum") {
      const float value = number(rest);
      if (value != std::floor(value) || value < 0.0f || value > 10.0f) fail(rest, "an integer from 0 to 10");
      material.illum = static_cast<int>(value);
    } else if (std::optional<float>* share = share_of(material, keyword)) {
      *share = clamped_share(material, keyword, rest);
    } else if (keyword == "Tf") {
      material.tf = color(keyword, rest);
    } else if (keyword == "Ka") {
      material.ka = ambient(rest);
    } else if (MtlMap* map = map_of(material, keyword)) {
      *map = {map_file(keyword, rest), location()};
    } else if (!changes_nothing(keyword, rest)) {
      material.has_map_d = material.has_map_d || keyword == "map_d";
      warn_once(keyword, in_quotes(keyword) + " is not understood and left out");
    }
  }

  static std::optional<float>* share_of(MtlMaterial& material, const std::string& keyword) {
    if (keyword == "Pr") return &material.pr;
    if (keyword == "Pm") return &material.pm;
    if (keyword == "d") return &material.d;
    return keyword == "Tr" ? &material.tr : nullptr;
  }

  static MtlMap* map_of(MtlMaterial& material, const std::string& keyword) {
    if (keyword == "map_Kd") return &material.map_kd;
    if (keyword == "map_Ks") return &material.map_ks;
    if (keyword == "map_Ke") return &material.map_ke;
    if (keyword == "map_Pr") return &material.map_pr;
    return keyword == "map_Pm" ? &material.map_pm : nullptr;
  }

  /// Pictures of ambient light are not modelled, and 0 is the default of the layers over a surface; how rough a coat is
  /// and how the grain runs means nothing without them.
  static bool changes_nothing(const std::string& keyword, std::string_view rest) {
    if (keyword == "map_Ka" || keyword == "Pcr" || keyword == "anisor") return true;
    const auto words = values_of(rest);
    return (keyword == "Ps" || keyword == "Pc" || keyword == "aniso") &&
           std::all_of(words.begin(), words.end(), [](std::string_view w) { return number_in(w) == 0.0f; });
  }

  float clamped_share(const MtlMaterial& material, const std::string& keyword, std::string_view rest) {
    constexpr std::string_view halo = "-halo";  // opaque at the silhouette
    if (keyword == "d" && rest.starts_with(halo)) {
      warn_once("-halo", "option " + in_quotes(halo) + " of d is left out");
      rest = trimmed(rest.substr(halo.size()));
    }
    const float value = number(rest);
    const float clamped = std::clamp(value, 0.0f, 1.0f);
    if (clamped != value) {
      warnings_.push_back(location() + ": material " + in_quotes(material.name) + " has " + keyword + " " +
                          number_text(value) + ", clamped to " + number_text(clamped));
    }
    return clamped;
  }

  /// Ambient light is not modelled; what its colour tells of metals in files of Blender is not worth an error.
  static std::optional<Rgb> ambient(std::string_view rest) {
    const auto words = values_of(rest);
    if (words.size() != 3 && words.size() != 1) return std::nullopt;
    Rgb value;
    for (int i = 0; i < 3; ++i) {
      const auto channel = number_in(words[words.size() == 1 ? 0 : static_cast<std::size_t>(i)]);
      if (!channel || *channel < 0.0f) return std::nullopt;
      value[i] = *channel;
    }
    return value;
  }

  float number(std::string_view rest) const {
    const auto words = values_of(rest);
    const auto value = words.size() == 1 ? number_in(words[0]) : std::nullopt;
    if (!value) fail(rest, "a finite number");
    return *value;
  }

  /// Three numbers, or one for all. Spectral curves and XYZ colours give a warning and no value.
  std::optional<Rgb> color(const std::string& keyword, std::string_view rest) {
    const auto words = values_of(rest);
    if (!words.empty() && (words[0] == "spectral" || words[0] == "xyz")) {
      warn_once(keyword + std::string(words[0]),
                in_quotes(keyword + " " + std::string(words[0])) + " is not understood and left out");
      return std::nullopt;
    }
    if (words.size() != 3 && words.size() != 1) fail(rest, "a colour r g b after " + keyword);
    Rgb value;
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = words[words.size() == 1 ? 0 : static_cast<std::size_t>(i)];
      const auto channel = number_in(word);
      if (!channel || *channel < 0.0f) fail(word, "a finite number, at least 0");
      value[i] = *channel;
    }
    return value;
  }

  /// The file name of a map, which may hold spaces, and stand before, after or between the options.
  std::string map_file(const std::string& keyword, std::string_view rest) {
    const auto words = words_of(rest);
    std::size_t first = words.size(), last = words.size();
    for (std::size_t i = 0; i < words.size(); ++i) {
      int values = option_values(words[i]);
      if (values == 0) {
        if (first == words.size()) first = i;
        if (last == words.size() || last + 1 == i) last = i;
        continue;
      }
      warn_once(keyword + std::string(words[i]), "option " + in_quotes(words[i]) + " of " + keyword + " is left out");
      const bool numbers_only = values == 3;  // -o, -s and -t end at the first word that is no number
      while (values-- > 0 && i + 1 < words.size() && !(numbers_only && !number_in(words[i + 1]))) ++i;
    }
    if (first == words.size()) fail(rest, "a file name after " + keyword);
    std::string name(words[first].data(), words[last].data() + words[last].size());
    if (name.size() > 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
  }

  std::string file_;
  std::vector<std::string>& warnings_;
  std::vector<MtlMaterial> materials_;
  std::map<std::string, int> line_of_;  // by name of the material
  std::set<std::string> warned_;
  MtlWriter writer_ = MtlWriter::unknown;
  bool skipping_ = false;  // inside a material whose name was taken
  int line_ = 0;
};

}  // namespace

bool MtlMaterial::is_plain() const {
  const int model = illum.value_or(2);
  return !d && !tr && !tf && !pr && !pm && (model < 4 || model == 6 || model == 10) && !map_ks && !map_ke && !map_pr &&
         !map_pm;
}

std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  return MtlReader(file, warnings).read(read_file(file));
}

}  // namespace raylab
