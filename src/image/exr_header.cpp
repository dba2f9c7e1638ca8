// Headers of OpenEXR files, which are not trusted.
#include "exr_header.hpp"

#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <fstream>
#include <map>

namespace raylab::detail {

namespace fs = std::filesystem;

namespace {

std::int32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return static_cast<std::int32_t>(value);
}

/// Whether an attribute's value has the size that OpenEXR takes it to have, whatever the file says of it.
bool fits(const std::string& type, const std::string& value) {
  static const std::map<std::string, std::size_t> fixed_sizes{{"box2f", 16},
                                                              {"box2i", 16},
                                                              {"chromaticities", 32},
                                                              {"compression", 1},
                                                              {"deepImageState", 1},
                                                              {"double", 8},
                                                              {"envmap", 1},
                                                              {"float", 4},
                                                              {"int", 4},
                                                              {"keycode", 28},
                                                              {"lineOrder", 1},
                                                              {"m33d", 72},
                                                              {"m33f", 36},
                                                              {"m44d", 128},
                                                              {"m44f", 64},
                                                              {"rational", 8},
                                                              {"tiledesc", 9},
                                                              {"timecode", 8},
                                                              {"v2d", 16},
                                                              {"v2f", 8},
                                                              {"v2i", 8},
                                                              {"v3d", 24},
                                                              {"v3f", 12},
                                                              {"v3i", 12}};
  if (const auto fixed = fixed_sizes.find(type); fixed != fixed_sizes.end()) return value.size() == fixed->second;
  if (type == "floatvector") return value.size() % 4 == 0;
  const std::uint64_t size = value.size();
  const auto number = [&](std::uint64_t at) { return static_cast<std::uint32_t>(little_endian(&value[at])); };
  if (type == "preview") {
    return size >= 8 && number(0) <= size && number(4) <= size && size == 8 + std::uint64_t{4} * number(0) * number(4);
  }
  std::uint64_t at = 0;
  if (type == "stringvector") {
    while (at + 4 <= size) at += 4 + number(at);
    return at == size;
  }
  if (type != "chlist") return true;  // strings, and what is not understood, are taken as long as they are
  while (at < size && value[at] != '\0') {
    at = value.find('\0', at);
    if (at == std::string::npos) return false;
    at += 17;  // with what is said of a channel
  }
  return at + 1 == size;
}

/// Throws where an attribute of a header is not what it says: OpenEXR makes room for what it is told, and goes on in
/// the middle of a value.
void check_attributes(std::istream& stream, std::uintmax_t size, bool many_parts) {
  std::string name, type, value;
  bool is_empty = false;
  do {
    is_empty = true;
    while (std::getline(stream, name, '\0') && !name.empty()) {
      is_empty = false;
      std::array<char, 4> length{};
      std::getline(stream, type, '\0');
      if (!stream.read(length.data(), length.size())) break;
      const std::int32_t bytes = little_endian(length.data());
      const bool inside =
          bytes >= 0 && static_cast<std::uintmax_t>(bytes) <= size - static_cast<std::uintmax_t>(stream.tellg());
      value.resize(inside ? static_cast<std::size_t>(bytes) : 0);
      if (!inside || !stream.read(value.data(), bytes) || !fits(type, value)) {
        throw Iex::InputExc("the header is damaged: attribute " + name + " has " + std::to_string(bytes) + " bytes");
      }
    }
    if (!stream) throw Iex::InputExc("the header ends early");
  } while (many_parts && !is_empty);
}

/// Lines that are compressed together.
std::int64_t lines_of(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 32;
  }
}

}  // namespace

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::vector<Imf::Header> read_exr_headers(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 8> start{};  // the magic number and the version
  if (!stream.read(start.data(), start.size())) throw Iex::InputExc("the header ends early");
  Imf::StdIFStream input(stream, file.c_str());
  int version = little_endian(&start[4]);
  if (Imf::isNonImage(version)) throw Iex::InputExc("deep pictures are not supported");
  check_attributes(stream, fs::file_size(file), Imf::isMultiPart(version));
  stream.seekg(start.size());
  std::vector<Imf::Header> headers;
  do {
    headers.emplace_back().readFrom(input, version);
    headers.back().sanityCheck(Imf::isTiled(version), Imf::isMultiPart(version));
    // The last one of many is followed by an empty name.
  } while (Imf::isMultiPart(version) && stream.peek() > 0);
  return headers;
}

void check_exr_memory(const Imf::Header& header, const fs::path& file) {
  const ExrSize data = size_of(header.dataWindow()), display = size_of(header.displayWindow());
  const std::int64_t budget = memory_budget(file);
  check_budget(data.width, data.height, file, budget);
  check_budget(display.width, display.height, file, budget);
  std::int64_t bytes = 0;  // of a pixel
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    bytes += c.channel().type == Imf::HALF ? 2 : 4;
  }
  std::int64_t width = data.width, lines = lines_of(header.compression());
  if (header.hasTileDescription()) {
    width = std::max<std::int64_t>(width, header.tileDescription().xSize);
    lines = header.tileDescription().ySize;
  }
  if (bytes > budget / width / lines) {
    throw Error(ErrorKind::input, file.string(),
                format("%" PRId64 " lines of %" PRId64 " pixels of %" PRId64
                       " bytes, which are read at a time, exceed this file's budget of %" PRId64 " MiB",
                       lines, width, bytes, budget >> 20));
  }
}

Attributes string_attributes(const Imf::Header& header) {
  Attributes attributes;
  for (auto a = header.begin(); a != header.end(); ++a) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
      attributes[a.name()] = text->value();
    }
  }
  return attributes;
}

}  // namespace raylab::detail
