// OpenEXR in and out: all of OpenEXR stays in this file.
#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cinttypes>
#include <exception>
#include <fstream>
#include <limits>
#include <map>

#include "formats.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

using Imath::Box2i;

half to_half(float x) { return half(std::clamp(x, -65504.0f, 65504.0f)); }

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

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

/// The first part's header, without the memory that OpenEXR sets aside for reading the pixels.
Imf::Header read_header(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 8> start{};  // the magic number and the version
  if (!stream.read(start.data(), start.size())) throw Iex::InputExc("the header ends early");
  Imf::StdIFStream input(stream, file.c_str());
  int version = little_endian(&start[4]);
  if (Imf::isNonImage(version)) throw Iex::InputExc("deep pictures are not supported");
  check_attributes(stream, fs::file_size(file), Imf::isMultiPart(version));
  stream.seekg(start.size());
  Imf::Header header;
  header.readFrom(input, version);
  header.sanityCheck(Imf::isTiled(version), Imf::isMultiPart(version));
  return header;
}

/// Calls read; whatever OpenEXR throws becomes Error (input).
template <class Read>
auto with_exr(const fs::path& file, const Read& read) {
  detail::open_input(file);  // for the system's reason when it cannot
  if (!Imf::isOpenExrFile(file.c_str())) throw Error(ErrorKind::input, file.string(), "not an OpenEXR file");
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, file.string(), "not readable as OpenEXR: " + one_line(e.what()));
  }
}

struct Size {
  std::int64_t width, height;
};
Size size_of(const Box2i& window) {
  return {std::int64_t{window.max.x} - window.min.x + 1, std::int64_t{window.max.y} - window.min.y + 1};
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

/// Throws where reading the pixels would take more memory than such a file may, before any is asked for.
void check_memory(const Imf::Header& header, const fs::path& file) {
  const Size data = size_of(header.dataWindow()), display = size_of(header.displayWindow());
  const std::int64_t budget = detail::memory_budget(file);
  detail::check_budget(data.width, data.height, file, budget);
  detail::check_budget(display.width, display.height, file, budget);
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

void check_channels(const Imf::ChannelList& channels, const fs::path& file) {
  std::string missing;
  for (const char* name : {"R", "G", "B"}) {
    if (channels.findChannel(name) == nullptr) missing += std::string(missing.empty() ? "" : " ") + name;
  }
  if (missing.empty()) return;
  std::string present;
  for (auto c = channels.begin(); c != channels.end(); ++c) present += std::string(" ") + c.name();
  throw Error(ErrorKind::input, file.string(),
              "channel " + missing + " missing; the file has" + (present.empty() ? " none" : present));
}

/// R, G and B of the data window into pixels of which the first is that of its upper left corner.
Imf::FrameBuffer rgb_buffer(Rgb* pixels, const Box2i& window, std::size_t row_stride) {
  Imf::FrameBuffer buffer;
  const std::array<const char*, 3> names{"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    // Addresses are counted from the pixel (0, 0), which may lie outside of the window.
    const auto origin = reinterpret_cast<std::intptr_t>(&pixels[0][c]) -
                        std::intptr_t{window.min.x} * static_cast<std::intptr_t>(sizeof(Rgb)) -
                        std::intptr_t{window.min.y} * static_cast<std::intptr_t>(row_stride);
    buffer.insert(names[static_cast<std::size_t>(c)],
                  Imf::Slice(Imf::FLOAT, std::bit_cast<char*>(origin), sizeof(Rgb), row_stride));
  }
  return buffer;
}

Image read_pixels(Imf::InputFile& input) {
  const Box2i data = input.header().dataWindow();
  const Box2i display = input.header().displayWindow();
  const Size size = size_of(display);
  Image image(static_cast<int>(size.width), static_cast<int>(size.height));
  if (data == display) {
    input.setFrameBuffer(rgb_buffer(image.pixels.data(), data, sizeof(Rgb) * static_cast<std::size_t>(size.width)));
    input.readPixels(data.min.y, data.max.y);
    return image;
  }
  // Row by row, of which the part that the display window shows is kept.
  std::vector<Rgb> row(static_cast<std::size_t>(size_of(data).width));
  input.setFrameBuffer(rgb_buffer(row.data(), data, 0));
  const int x_begin = std::max(data.min.x, display.min.x);
  const int x_last = std::min(data.max.x, display.max.x);
  for (int y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y) {
    input.readPixels(y);
    if (x_begin > x_last) continue;
    const auto first = row.begin() + (x_begin - data.min.x);
    std::copy(first, first + (x_last - x_begin + 1), &image.at(x_begin - display.min.x, y - display.min.y));
  }
  return image;
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

/// R, G, B, A and the layers, in the memory layout that the frame buffer given to OpenEXR points into.
class OutputChannels {
 public:
  OutputChannels(const Image& image, const std::vector<Layer>& layers, Imf::Header& header) : header_(header) {
    const std::size_t count = image.pixels.size();
    row_ = static_cast<std::size_t>(image.width);
    rgba_.reserve(count);
    for (const Rgb& p : image.pixels) rgba_.push_back({to_half(p.r), to_half(p.g), to_half(p.b), half(1.0f)});
    halves_.reserve(layers.size());
    const std::array<const char*, 4> names{"R", "G", "B", "A"};
    for (std::size_t c = 0; c < names.size(); ++c) insert(names[c], Imf::HALF, &rgba_[0][c], sizeof(rgba_[0]));
    for (const Layer& layer : layers) {
      RAYLAB_CHECK(layer.values.size() == count);
      if (layer.as_float) {
        insert(layer.name, Imf::FLOAT, layer.values.data(), sizeof(float));
      } else {
        std::vector<half>& values = halves_.emplace_back(count);
        std::transform(layer.values.begin(), layer.values.end(), values.begin(), to_half);
        insert(layer.name, Imf::HALF, values.data(), sizeof(half));
      }
    }
  }

  const Imf::FrameBuffer& frame_buffer() const { return buffer_; }

 private:
  void insert(const std::string& name, Imf::PixelType type, const void* values, std::size_t stride) {
    RAYLAB_CHECK(header_.channels().findChannel(name) == nullptr);
    header_.channels().insert(name, Imf::Channel(type));
    // OpenEXR reads and writes through one type of slice; when writing a file it only reads from it.
    buffer_.insert(name, Imf::Slice(type, static_cast<char*>(const_cast<void*>(values)), stride, stride * row_));
  }

  Imf::Header& header_;
  Imf::FrameBuffer buffer_;
  std::size_t row_ = 0;
  std::vector<std::array<half, 4>> rgba_;
  std::vector<std::vector<half>> halves_;
};

}  // namespace

void write_exr(const fs::path& file, const Image& image, const std::vector<Layer>& layers,
               const Attributes& attributes) {
  RAYLAB_CHECK(image.width > 0 && image.height > 0);
  AtomicFile output(file);
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));
    const OutputChannels channels(image, layers, header);
    Imf::StdOFStream stream(output.stream(), file.c_str());
    Imf::OutputFile exr(stream, header);
    exr.setFrameBuffer(channels.frame_buffer());
    exr.writePixels(image.height);
  } catch (const std::exception& e) {
    throw Error(ErrorKind::output, file.string(), "cannot be written: " + one_line(e.what()));
  }
  // Only here is the table of lines complete: OpenEXR writes it on destruction, and is silent when that fails.
  output.commit();
}

Image read_exr(const fs::path& file) {
  return with_exr(file, [&] {
    const Imf::Header header = read_header(file);
    check_channels(header.channels(), file);
    check_memory(header, file);
    Imf::InputFile input(file.c_str());
    return read_pixels(input);
  });
}

ImageInfo detail::read_exr_info(const fs::path& file) {
  return with_exr(file, [&] {
    const Imf::Header header = read_header(file);
    const Size size = size_of(header.displayWindow());
    if (size.width > std::numeric_limits<int>::max() || size.height > std::numeric_limits<int>::max()) {
      throw Iex::InputExc("the display window is too large");
    }
    ImageInfo info{static_cast<int>(size.width), static_cast<int>(size.height), {}, string_attributes(header)};
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const Imf::PixelType type = c.channel().type;
      info.channels.push_back(std::string(c.name()) + (type == Imf::HALF    ? " half"
                                                       : type == Imf::FLOAT ? " float"
                                                                            : " uint"));
    }
    return info;
  });
}

Attributes read_exr_attributes(const fs::path& file) { return detail::read_exr_info(file).attributes; }

}  // namespace raylab
