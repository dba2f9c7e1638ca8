#include "ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include "message_text.hpp"

namespace raylab {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> types[] = {
      {"char", PlyType::int8},      {"uchar", PlyType::uint8},    {"short", PlyType::int16},
      {"ushort", PlyType::uint16},  {"int", PlyType::int32},      {"uint", PlyType::uint32},
      {"float", PlyType::float32},  {"double", PlyType::float64}, {"int8", PlyType::int8},
      {"uint8", PlyType::uint8},    {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
      {"int32", PlyType::int32},    {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
      {"float64", PlyType::float64}};
  for (const auto& [known, type] : types) {
    if (name == known) return type;
  }
  return std::nullopt;
}

class HeaderReader {
 public:
  HeaderReader(WordReader& words, std::vector<std::string>& warnings) : words_(words), warnings_(warnings) {}

  PlyHeader read() {
    if (const std::string_view magic = words_.word(); words_.line() != 1 || magic != "ply") words_.fail(magic, "ply");
    end_of_line();
    std::optional<PlyHeader::Format> format;
    for (;;) {
      if (!words_.find_word()) words_.fail("", "end_header");
      const std::string_view keyword = words_.word();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        format = read_format();
      } else if (keyword == "element") {
        read_element();
      } else if (keyword == "property") {
        read_property();
      } else if (keyword == "comment") {
        read_comment();
      } else if (keyword != "obj_info") {
        not_understood(keyword);
      }
      words_.rest_of_line();
    }
    if (!format) words_.fail("end_header", "a format before it");
    end_of_line();
    header_.format = *format;
    return std::move(header_);
  }

 private:
  PlyHeader::Format read_format() {
    const std::string_view name = words_.word();
    const std::string_view version = words_.word();
    if (!version.empty() && version != "1.0") words_.fail(version, "version 1.0");
    end_of_line();
    if (name == "ascii") return PlyHeader::Format::ascii;
    if (name == "binary_little_endian") return PlyHeader::Format::little_endian;
    if (name == "binary_big_endian") return PlyHeader::Format::big_endian;
    words_.fail(name, "ascii, binary_little_endian or binary_big_endian");
  }

  void read_element() {
    PlyElement element;
    element.line = words_.line();
    element.name = word_of("the name of an element");
    const std::string_view count = words_.word();
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (count.empty() || error != std::errc() || end != count.data() + count.size()) {
      words_.fail(count, "how many there are of element " + in_quotes(element.name));
    }
    end_of_line();
    if (!element_names_.insert(element.name).second)
      words_.fail(element.name, "another name: there is such an element");
    property_names_.clear();
    header_.elements.push_back(std::move(element));
  }

  PlyType read_type(std::string_view name) {
    const auto type = type_named(name);
    if (!type) words_.fail(name, "a type: char, uchar, short, ushort, int, uint, float or double");
    return *type;
  }

  void read_property() {
    PlyProperty property;
    property.line = words_.line();
    std::string_view type = words_.word();
    if (type == "list") {
      const std::string_view count = words_.word();
      property.count = read_type(count);
      type = words_.word();
    }
    property.type = read_type(type);
    property.name = word_of("the name of a property");
    end_of_line();
    if (header_.elements.empty()) words_.fail("property", "an element before it");
    if (!property_names_.insert(property.name).second) {
      words_.fail(property.name, "another name: the element has such a property");
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  void read_comment() {
    if (words_.word() != "TextureFile") return;
    std::string name(words_.rest_of_line());
    std::replace(name.begin(), name.end(), '\\', '/');
    if (name.empty()) words_.fail("", "the name of a picture");
    if (!header_.texture.empty()) {
      if (std::exchange(warned_of_texture_, true)) return;
      warnings_.push_back(words_.location() + ": texture " + in_quotes(name) +
                          " is left out, as is any other: the mesh has the first");
      return;
    }
    header_.texture = std::move(name);
    header_.texture_line = words_.line();
  }

  std::string word_of(const char* what) {
    const std::string_view word = words_.word();
    if (word.empty()) words_.fail(word, what);
    return std::string(word);
  }

  void end_of_line() {
    if (const std::string_view word = words_.word(); !word.empty()) words_.fail(word, "the end of the line");
  }

  void not_understood(std::string_view keyword) {
    if (std::exchange(warned_of_line_, true)) return;
    warnings_.push_back(words_.location() + ": " + in_quotes(keyword) + " is not understood and left out");
  }

  WordReader& words_;
  std::vector<std::string>& warnings_;
  PlyHeader header_;
  std::set<std::string> element_names_, property_names_;
  bool warned_of_line_ = false, warned_of_texture_ = false;
};

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> PlyElement::find(std::string_view name) const {
  const auto found = std::find_if(properties.begin(), properties.end(), [&](const auto& p) { return p.name == name; });
  if (found == properties.end()) return std::nullopt;
  return static_cast<std::size_t>(found - properties.begin());
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.count.has_value(); });
}

std::size_t PlyElement::smallest() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += property.smallest();
  return bytes;
}

PlyHeader read_ply_header(std::string_view text, WordReader& words, std::vector<std::string>& warnings) {
  PlyHeader header = HeaderReader(words, warnings).read();
  // Of a binary file, what looks like more of a line end may be the first element's: how the first line ends tells.
  const std::string_view rest = text.substr(words.at());
  const bool two = rest.starts_with("\r\n") && text.substr(text.find_first_of("\r\n")).starts_with("\r\n");
  header.end = words.at() + (two ? 2 : std::min<std::size_t>(rest.size(), 1));
  return header;
}

}  // namespace raylab
