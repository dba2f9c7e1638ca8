// OpenEXR in and out: all of OpenEXR stays in this file.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <exception>

#include "formats.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

using Imath::Box2i;

half to_half(float x) { return half(std::clamp(x, -65504.0f, 65504.0f)); }

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Calls read with the opened file; whatever OpenEXR throws becomes Error (input).
template <class Read>
auto with_exr(const fs::path& file, const Read& read) {
  detail::open_input(file);  // for the system's reason when it cannot
  if (!Imf::isOpenExrFile(file.c_str())) throw Error(ErrorKind::input, file.string(), "not an OpenEXR file");
  try {
    Imf::InputFile input(file.c_str());
    return read(input);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, file.string(), "not readable as OpenEXR: " + one_line(e.what()));
  }
}

/// Width and height of a window that is neither empty nor beyond kMostPixels.
struct Size {
  int width, height;
};
Size size_of(const Box2i& window, const fs::path& file) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width <= 0 || height <= 0 || width > kMostPixels / height) {
    throw Error(ErrorKind::input, file.string(),
                "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels is not supported; expected 1 to 2^28");
  }
  return {static_cast<int>(width), static_cast<int>(height)};
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

/// The part of the data window that the display window shows, in a picture of the display window's size.
Image show(const Image& data, const Box2i& data_window, const Box2i& display_window, const Size& display) {
  Image image(display.width, display.height);
  const int x_begin = std::max(data_window.min.x, display_window.min.x);
  const int x_end = std::min(data_window.max.x, display_window.max.x) + 1;
  const int y_begin = std::max(data_window.min.y, display_window.min.y);
  const int y_end = std::min(data_window.max.y, display_window.max.y) + 1;
  for (int y = y_begin; y < y_end && x_begin < x_end; ++y) {
    const Rgb* row = &data.at(x_begin - data_window.min.x, y - data_window.min.y);
    std::copy(row, row + (x_end - x_begin), &image.at(x_begin - display_window.min.x, y - display_window.min.y));
  }
  return image;
}

Image read_pixels(Imf::InputFile& input, const fs::path& file) {
  const Box2i data_window = input.header().dataWindow();
  const Box2i display_window = input.header().displayWindow();
  check_channels(input.header().channels(), file);
  const Size size = size_of(data_window, file);
  const Size display = size_of(display_window, file);
  Image data(size.width, size.height);
  Imf::FrameBuffer buffer;
  const std::array<const char*, 3> names{"R", "G", "B"};
  for (std::size_t c = 0; c < names.size(); ++c) {
    buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &data.pixels[0][static_cast<int>(c)], data_window, sizeof(Rgb),
                                             sizeof(Rgb) * static_cast<std::size_t>(size.width)));
  }
  input.setFrameBuffer(buffer);
  input.readPixels(data_window.min.y, data_window.max.y);
  return data_window == display_window ? data : show(data, data_window, display_window, display);
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
  return with_exr(file, [&](Imf::InputFile& input) { return read_pixels(input, file); });
}

ImageInfo detail::read_exr_info(const fs::path& file) {
  return with_exr(file, [&](const Imf::InputFile& input) {
    const Imf::Header& header = input.header();
    const Size size = size_of(header.displayWindow(), file);
    ImageInfo info{size.width, size.height, {}, string_attributes(header)};
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
