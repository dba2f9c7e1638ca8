#include "raylab/image/film_file.hpp"

#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>

#include <bit>
#include <cstring>
#include <new>

#include "exr_header.hpp"
#include "film_info.hpp"
#include "raylab/core/check.hpp"

namespace raylab {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "rows of films are read as they lie in the file");

namespace {

constexpr const char* kPartName = "film";
/// In the order of Film::row_words(), which is that of the names; the last checks the others.
std::vector<std::string> channel_names() {
  std::vector<std::string> names{"kept"};
  for (int i = 0; i < 3; ++i) names.push_back("octave." + std::to_string(i));
  for (const auto& [name, words] : {std::pair("square.", 3), std::pair("sum.", 4)}) {
    for (const char* color : {"B.", "G.", "R."}) {
      for (int i = 0; i < words; ++i) names.push_back(std::string(name) + color + std::to_string(i));
    }
  }
  names.emplace_back("taken");
  RAYLAB_CHECK(names.size() == Film::kWords);
  names.emplace_back("verify");
  return names;
}
constexpr std::size_t kChannels = Film::kWords + 1;

/// A polynomial of the words of each pixel, odd at each step, so that no change of one word goes unseen; it begins
/// with the file's header and the pixel's place.
void checks_of(const std::uint32_t* words, std::size_t width, int y, std::uint32_t seed, std::uint32_t* checks) {
  constexpr std::uint32_t kStep = 0x9e3779b1u;
  for (std::size_t x = 0; x < width; ++x) {
    checks[x] = (seed + static_cast<std::uint32_t>(y)) * kStep + static_cast<std::uint32_t>(x);
  }
  for (std::size_t k = 0; k < Film::kWords; ++k) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint32_t mixed = checks[x] ^ checks[x] >> 15;
      checks[x] = mixed * kStep + words[k * width + x];
    }
  }
}

/// Throws where the headers are not those of a film file.
void check_headers(const std::vector<Imf::Header>& headers, const fs::path& file) {
  if (headers.size() != 2 || !headers[1].hasName() || headers[1].name() != kPartName) {
    throw Error(ErrorKind::input, file.string(),
                "is a picture without a film: --film or --samples of raylab-render writes one");
  }
  const Imf::Header& header = headers[1];
  const auto damaged = [](const std::string& what) { throw Iex::InputExc("its film has " + what); };
  const detail::ExrSize size = detail::size_of(header.dataWindow());
  if (header.dataWindow().min != Imath::V2i(0) || size.width < 1 || size.height < 1 ||
      size.width > kMostPixels / size.height) {
    damaged("a size that is not supported");
  }
  // The first part is not read, but OpenEXR makes room for its table of lines.
  if (headers[0].dataWindow() != header.dataWindow() || headers[0].type() != Imf::SCANLINEIMAGE) {
    damaged("another size than its picture");
  }
  if (header.type() != Imf::SCANLINEIMAGE || header.compression() != Imf::NO_COMPRESSION ||
      header.lineOrder() != Imf::INCREASING_Y) {
    damaged("another layout");
  }
  detail::check_version(detail::string_attributes(header), file);
  const std::vector<std::string> names = channel_names();
  std::size_t known = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++known) {
    const Imf::Channel& channel = c.channel();
    if (known == names.size() || names[known] != c.name() || channel.type != Imf::UINT || channel.xSampling != 1 ||
        channel.ySampling != 1) {
      damaged(std::string("another channel ") + c.name());
    }
  }
  if (known != names.size()) damaged("too few channels");
  // As nothing is compressed, the file bounds the memory that is asked for.
  if (static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height) * kChannels * 4 >
      fs::file_size(file)) {
    damaged("more pixels than the file; it ends early");
  }
}

}  // namespace

bool fits_half(const Film& film) {
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      if (!detail::fits_half(film.mean(x, y))) return false;
    }
  }
  return true;
}

void write_film_picture(const fs::path& file, FilmPicture picture) {
  const bool is_png = detail::output_format(file) == detail::Format::png;
  if (is_png) {
    picture.layers.clear();
    picture.variance = picture.samples = false;
  }
  constexpr int kBlock = 16;  // rows asked for at a time
  std::optional<Film> block;
  int block_first = 0;
  detail::PictureRows rows{picture.width, picture.height, picture.as_float, {}, {}};
  for (const Layer& layer : picture.layers) rows.layers.emplace_back(layer.name, layer.as_float);
  if (picture.variance) {
    for (const char* name : {"variance.R", "variance.G", "variance.B"}) rows.layers.emplace_back(name, true);
  }
  if (picture.samples) rows.layers.emplace_back("sampleCount", true);
  rows.fill = [&](int y, Rgb* pixels, float* values) {
    if (!block || y >= block_first + block->height()) {
      block_first = y;
      block = picture.rows(y, std::min(kBlock, picture.height - y));
    }
    const int row = y - block_first;
    for (int x = 0; x < picture.width; ++x) pixels[x] = block->mean(x, row);
    for (const Layer& layer : picture.layers) {
      values = std::copy_n(layer.values.begin() + std::ptrdiff_t{y} * picture.width, picture.width, values);
    }
    for (int c = 0; picture.variance && c < 3; ++c) {
      for (int x = 0; x < picture.width; ++x) *values++ = Rgb(block->variance_of_mean(x, row))[c];
    }
    for (int x = 0; picture.samples && x < picture.width; ++x) *values++ = static_cast<float>(block->samples(x, row));
  };
  if (is_png) return detail::write_png(file, rows);
  if (!picture.film) return detail::write_exr(file, rows, picture.attributes, nullptr);
  detail::WordRows words{
      kPartName, detail::attributes_of(*picture.film, picture.width, picture.height), channel_names(), {}};
  const auto seed = static_cast<std::uint32_t>(detail::hash_of(words.attributes));
  words.fill = [&](int y, std::uint32_t* row) {
    const auto width = static_cast<std::size_t>(picture.width);
    block->row_words(y - block_first, row);
    checks_of(row, width, y, seed, row + Film::kWords * width);
  };
  detail::write_exr(file, rows, picture.attributes, &words);
}

struct FilmFile::Exr {
  explicit Exr(const fs::path& file) : input(file.c_str(), 0, false), part(input, 1) {}

  Imf::MultiPartInputFile input;
  Imf::InputPart part;
};

FilmFile::FilmFile(const fs::path& file) : file_(file) {
  detail::with_exr(file, [&] {
    const std::vector<Imf::Header> headers = detail::read_exr_headers(file);
    check_headers(headers, file);
    const detail::ExrSize size = detail::size_of(headers[1].dataWindow());
    width_ = static_cast<int>(size.width);
    height_ = static_cast<int>(size.height);
    const Attributes attributes = detail::string_attributes(headers[1]);
    Attributes own;
    for (const auto& [name, value] : attributes) {
      if (name.starts_with("raylab.")) own[name] = value;
    }
    info_ = detail::info_of(own, width_, height_, file);
    check_seed_ = static_cast<std::uint32_t>(detail::hash_of(own));
    attributes_ = detail::string_attributes(headers[0]);
    for (const char* of_many_parts : {"name", "type"}) attributes_.erase(of_many_parts);
    exr_ = std::make_unique<Exr>(file);
  });
}

FilmFile::~FilmFile() = default;
FilmFile::FilmFile(FilmFile&&) noexcept = default;

bool FilmFile::is_one(const fs::path& file) noexcept {
  try {
    const std::vector<Imf::Header> headers = detail::with_exr(file, [&] { return detail::read_exr_headers(file); });
    return headers.size() == 2 && headers[1].hasName() && headers[1].name() == kPartName;
  } catch (const std::exception&) {
    return false;
  }
}

DamagedRow FilmFile::read_row(int y, std::vector<std::uint32_t>& words) {
  const auto width = static_cast<std::size_t>(width_);
  words.resize(kChannels * width);
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorKind::input, file_.string(), format("its film is damaged in row %d: ", y) + why);
  };
  try {
    const char* bytes = nullptr;
    int size = 0;
    exr_->part.rawPixelData(y, bytes, size);
    if (size < 0 || static_cast<std::size_t>(size) != 4 * words.size()) fail("it has another size");
    std::memcpy(words.data(), bytes, 4 * words.size());
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    fail(detail::one_line(e.what()));
  }
  std::uint64_t most = 0;  // that may have been taken
  for (const SampleRange& range : info_.ranges) most += range.end - range.first;
  std::vector<std::uint32_t> checks(width);
  checks_of(words.data(), width, y, check_seed_, checks.data());
  const std::uint32_t* const kept = words.data();
  const std::uint32_t* const all = &words[(Film::kWords - 1) * width];
  DamagedRow damage{y, 0, 0};
  for (std::size_t x = 0; x < width; ++x) {
    if (checks[x] == words[Film::kWords * width + x] && kept[x] <= all[x] && all[x] <= most) continue;
    if (damage.pixels++ == 0) damage.first = static_cast<int>(x);
  }
  return damage;
}

SampleRange FilmFile::add_to(Film& film) {
  RAYLAB_CHECK(film.width() == width_ && film.height() == height_);
  std::vector<std::uint32_t> words;
  SampleRange taken{0xffffffffu, 0};
  std::uint64_t pixels = 0;  // that have samples
  for (int y = 0; y < height_; ++y) {
    const DamagedRow damage = read_row(y, words);
    if (damage.pixels > 0) {
      throw Error(ErrorKind::input, file_.string(), format("its film is damaged at pixel %d, %d", damage.first, y));
    }
    const std::uint32_t* const all = &words[(Film::kWords - 1) * static_cast<std::size_t>(width_)];
    for (int x = 0; x < width_; ++x) {
      if (all[x] == 0) continue;
      ++pixels;
      taken.first = std::min(taken.first, all[x]);
      taken.end = std::max(taken.end, all[x]);
    }
    film.add_row_words(y, words.data());
  }
  if (pixels < info_.pixels || pixels == 0) taken.first = 0;
  return taken;
}

std::vector<DamagedRow> FilmFile::damaged_rows() {
  std::vector<std::uint32_t> words;
  std::vector<DamagedRow> rows;
  for (int y = 0; y < height_; ++y) {
    try {
      const DamagedRow row = read_row(y, words);
      if (row.pixels > 0) rows.push_back(row);
    } catch (const Error&) {
      rows.push_back({y, width_, 0});
    }
  }
  return rows;
}

}  // namespace raylab
