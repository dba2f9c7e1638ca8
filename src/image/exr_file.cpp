// OpenEXR in and out: all of OpenEXR stays in this file and exr_header.cpp, and film_file.cpp for sums.
#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <new>

#include "exr_header.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

using Imath::Box2i;

half to_half(float x) { return half(std::clamp(x, -65504.0f, 65504.0f)); }

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
  const detail::ExrSize size = detail::size_of(display);
  Image image(static_cast<int>(size.width), static_cast<int>(size.height));
  if (data == display) {
    input.setFrameBuffer(rgb_buffer(image.pixels.data(), data, sizeof(Rgb) * static_cast<std::size_t>(size.width)));
    input.readPixels(data.min.y, data.max.y);
    return image;
  }
  // Row by row, of which the part that the display window shows is kept.
  std::vector<Rgb> row(static_cast<std::size_t>(detail::size_of(data).width));
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

/// A row of R, G, B, A and the layers, which the frame buffer given to OpenEXR points into.
class RowChannels {
 public:
  RowChannels(const detail::PictureRows& picture, Imf::Header& header)
      : header_(header), width_(static_cast<std::size_t>(picture.width)), as_float_(picture.as_float) {
    rgb_.resize(width_);
    rgba_.resize(4 * width_, 1.0f);
    halves_.resize(4 * width_, half(1.0f));
    const std::array<const char*, 4> names{"R", "G", "B", "A"};
    for (std::size_t c = 0; c < names.size(); ++c) {
      insert(names[c], as_float_ ? slice(&rgba_[c * width_]) : slice(&halves_[c * width_]));
    }
    layers_.resize(width_ * picture.layers.size());
    layer_halves_.resize(layers_.size());
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
      const auto& [name, as_float] = picture.layers[i];
      insert(name, as_float ? slice(&layers_[i * width_]) : slice(&layer_halves_[i * width_]));
    }
  }

  const Imf::FrameBuffer& frame_buffer() const { return buffer_; }

  void fill(const detail::PictureRows& picture, int y) {
    picture.fill(y, rgb_.data(), layers_.data());
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t x = 0; x < width_; ++x) rgba_[c * width_ + x] = rgb_[x][static_cast<int>(c)];
    }
    if (!as_float_) std::transform(rgba_.begin(), rgba_.end(), halves_.begin(), to_half);
    std::transform(layers_.begin(), layers_.end(), layer_halves_.begin(), to_half);
  }

 private:
  // Every row is written from the same place.
  static Imf::Slice slice(float* values) { return {Imf::FLOAT, reinterpret_cast<char*>(values), sizeof(float), 0}; }
  static Imf::Slice slice(half* values) { return {Imf::HALF, reinterpret_cast<char*>(values), sizeof(half), 0}; }

  void insert(const std::string& name, const Imf::Slice& slice) {
    RAYLAB_CHECK(header_.channels().findChannel(name) == nullptr);
    header_.channels().insert(name, Imf::Channel(slice.type));
    buffer_.insert(name, slice);
  }

  Imf::Header& header_;
  Imf::FrameBuffer buffer_;
  std::size_t width_;
  bool as_float_;
  std::vector<Rgb> rgb_;
  std::vector<float> rgba_, layers_;
  std::vector<half> halves_, layer_halves_;
};

Imf::Header header_of(int width, int height, Imf::Compression compression, const Attributes& attributes) {
  Imf::Header header(width, height);
  header.compression() = compression;
  for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));
  return header;
}

void write_one_part(Imf::OStream& stream, const detail::PictureRows& picture, const Imf::Header& header,
                    RowChannels& channels) {
  Imf::OutputFile exr(stream, header);
  exr.setFrameBuffer(channels.frame_buffer());
  for (int y = 0; y < picture.height; ++y) {
    channels.fill(picture, y);
    exr.writePixels(1);
  }
}

/// The picture, and beside it the words, row by row: of a film that is rendered on meanwhile both are the same state.
void write_two_parts(Imf::OStream& stream, const detail::PictureRows& picture, Imf::Header header,
                     RowChannels& channels, const detail::WordRows& words) {
  header.setName("picture");
  header.setType(Imf::SCANLINEIMAGE);
  // Uncompressed: both are read and written as fast as the disk, and sums have little to compress but their zeros.
  header.compression() = Imf::NO_COMPRESSION;
  Imf::Header second = header_of(picture.width, picture.height, Imf::NO_COMPRESSION, words.attributes);
  second.setName(words.name);
  second.setType(Imf::SCANLINEIMAGE);
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<std::uint32_t> row(width * words.channels.size());
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < words.channels.size(); ++c) {
    second.channels().insert(words.channels[c], Imf::Channel(Imf::UINT));
    buffer.insert(words.channels[c], Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&row[c * width]), 4, 0));
  }
  const std::array<Imf::Header, 2> headers{header, second};
  Imf::MultiPartOutputFile exr(stream, headers.data(), 2);
  Imf::OutputPart pixels(exr, 0), sums(exr, 1);
  pixels.setFrameBuffer(channels.frame_buffer());
  sums.setFrameBuffer(buffer);
  for (int y = 0; y < picture.height; ++y) {
    channels.fill(picture, y);
    pixels.writePixels(1);
    words.fill(y, row.data());
    sums.writePixels(1);
  }
}

}  // namespace

void detail::write_exr(const fs::path& file, const PictureRows& picture, const Attributes& attributes,
                       const WordRows* words) {
  RAYLAB_CHECK(picture.width > 0 && picture.height > 0);
  AtomicFile output(file);
  try {
    Imf::Header header = header_of(picture.width, picture.height, Imf::ZIP_COMPRESSION, attributes);
    RowChannels channels(picture, header);
    Imf::StdOFStream stream(output.stream(), file.c_str());
    if (words == nullptr) {
      write_one_part(stream, picture, header, channels);
    } else {
      write_two_parts(stream, picture, header, channels, *words);
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::output, file.string(), "cannot be written: " + one_line(e.what()));
  }
  // Only here is the table of lines complete: OpenEXR writes it on destruction, and is silent when that fails.
  output.commit();
}

void write_exr(const fs::path& file, const Image& image, const std::vector<Layer>& layers, const Attributes& attributes,
               bool as_float) {
  detail::PictureRows rows = detail::rows_of(image, layers);
  rows.as_float = as_float;
  detail::write_exr(file, rows, attributes, nullptr);
}

bool detail::fits_half(const Rgb& color) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(color[c]) > 65504.0f || (color[c] != 0.0f && half(color[c]) == 0.0f)) return false;
  }
  return true;
}

bool fits_half(const Image& image) {
  return std::all_of(image.pixels.begin(), image.pixels.end(), [](const Rgb& p) { return detail::fits_half(p); });
}

Image read_exr(const fs::path& file) {
  return detail::with_exr(file, [&] {
    const std::vector<Imf::Header> headers = detail::read_exr_headers(file);
    check_channels(headers.front().channels(), file);
    // Of the other parts too: OpenEXR makes room for their tables of lines.
    for (const Imf::Header& header : headers) detail::check_exr_memory(header, file);
    Imf::InputFile input(file.c_str());
    return read_pixels(input);
  });
}

ImageInfo detail::read_exr_info(const fs::path& file) {
  return with_exr(file, [&] {
    const Imf::Header header = detail::read_exr_headers(file).front();
    const ExrSize size = size_of(header.displayWindow());
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
