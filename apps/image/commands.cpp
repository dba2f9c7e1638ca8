#include "commands.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/film_file.hpp"
#include "raylab/image/metrics.hpp"

namespace raylab::app {

namespace fs = std::filesystem;

void compare(const fs::path& image_file, const fs::path& reference_file, bool as_json) {
  const Image image = read_image(image_file);
  const ImageError error = image_error(image, read_image(reference_file));
  const std::size_t pixels = image.pixels.size();
  if (as_json) {
    const nlohmann::ordered_json row{{"relmse", error.relmse},
                                     {"relmse_trimmed", error.relmse_trimmed},
                                     {"mse", error.mse},
                                     {"mean_ratio", error.mean_ratio},
                                     {"mean_ratio_error", error.mean_ratio_error},
                                     {"different_pixels", error.different_pixels},
                                     {"pixels", pixels}};
    std::printf("%s\n", row.dump(2).c_str());
    return;
  }
  std::printf("relMSE            %.6g\n", error.relmse);
  std::printf("relMSE, trimmed   %.6g   (without the worst 0.1%% of the pixels)\n", error.relmse_trimmed);
  std::printf("MSE               %.6g\n", error.mse);
  std::printf("mean ratio        %.6g ± %.2g\n", error.mean_ratio, error.mean_ratio_error);
  std::printf("differing pixels  %zu of %zu\n", error.different_pixels, pixels);
}

void convert(const fs::path& input, const fs::path& output, double exposure_stops) {
  check_writable_image(output);
  Image image = read_image(input);
  const auto scale = static_cast<float>(std::exp2(exposure_stops));
  for (Rgb& pixel : image.pixels) pixel *= scale;
  const bool as_float = lowercase_ending(output) == ".exr" && !fits_half(image);
  if (as_float) {
    std::fprintf(stderr, "raylab-image: warning: %s holds floats, as half would lose values beyond 65504 or near 0\n",
                 output.c_str());
  }
  write_image(output, image, {}, read_image_info(input).attributes, as_float);
}

namespace {

/// The least and the most of each channel, and how many values are no numbers.
void print_ranges(const Image& image) {
  for (int c = 0; c < 3; ++c) {
    float least = std::numeric_limits<float>::max(), most = -least;
    std::size_t odd = 0;
    for (const Rgb& pixel : image.pixels) {
      odd += !std::isfinite(pixel[c]);
      if (!std::isfinite(pixel[c])) continue;
      least = std::min(least, pixel[c]);
      most = std::max(most, pixel[c]);
    }
    std::printf("range %c: ", "RGB"[c]);
    if (odd < image.pixels.size()) std::printf("%.6g to %.6g", static_cast<double>(least), static_cast<double>(most));
    if (odd > 0) std::printf("%s%zu not finite", odd < image.pixels.size() ? ", " : "", odd);
    std::printf("\n");
  }
}

/// Throws where sums of the film are not as they were written, with the first rows that have damaged pixels.
void check_sums(FilmFile& film) {
  const std::vector<DamagedRow> rows = film.damaged_rows();
  if (rows.empty()) return;
  constexpr std::size_t kMostNamed = 5;
  std::int64_t pixels = 0;
  std::string where;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    pixels += rows[i].pixels;
    if (i < kMostNamed)
      where += format("%s row %d: %d from x = %d", i ? ";" : "", rows[i].y, rows[i].pixels, rows[i].first);
  }
  if (rows.size() > kMostNamed) where += "; and more";
  throw Error(
      ErrorKind::input, film.name().string(),
      format("its film is damaged in %zu rows of %d, at %" PRId64 " pixels:", rows.size(), film.height(), pixels) +
          where);
}

}  // namespace

void info(const fs::path& file) {
  const ImageInfo info = read_image_info(file);
  std::printf("size: %d x %d\n", info.width, info.height);
  std::printf("channels:");
  const char* separator = " ";
  for (const std::string& channel : info.channels) {
    std::printf("%s%s", separator, channel.c_str());
    separator = ", ";
  }
  std::printf("\n");
  const auto is_there = [&](const char* name) {
    return std::any_of(info.channels.begin(), info.channels.end(),
                       [&](const std::string& channel) { return channel.starts_with(name); });
  };
  if (is_there("Y 8-bit") || (is_there("R ") && is_there("G ") && is_there("B "))) print_ranges(read_image(file));
  for (const auto& [name, value] : info.attributes) std::printf("%s: %s\n", name.c_str(), value.c_str());
  if (!FilmFile::is_one(file)) return;
  FilmFile opened(file);
  const FilmInfo& film = opened.info();
  std::printf("film:");
  for (const SampleRange& range : film.ranges) std::printf(" samples %s", to_string(range).c_str());
  std::printf(" of %u\n", film.wanted);
  for (const auto& [name, value] : film.settings) std::printf("film %s: %s\n", name.c_str(), value.c_str());
  check_sums(opened);
  std::printf("film sums: whole\n");
}

void diff(const fs::path& image, const fs::path& reference, const fs::path& output, double full_scale) {
  check_writable_image(output);
  write_image(output, error_picture(read_image(image), read_image(reference), full_scale));
}

}  // namespace raylab::app
