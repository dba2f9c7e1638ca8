#include "raylab/image/film.hpp"

#include <limits>

#include "raylab/core/check.hpp"

namespace raylab {

namespace {

std::size_t pixel_count(int width, int height) {
  RAYLAB_CHECK(width > 0 && height > 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

Film::Film(int width, int height)
    : width_(width), height_(height), sums_(pixel_count(width, height)), samples_(sums_.size()) {}

Rgb Film::mean(int x, int y) const {
  const std::size_t i = index(x, y);
  if (samples_[i] == 0) return Rgb(0.0f);
  const double n = samples_[i];
  const ExactSum* sum = sums_[i].rgb;
  return Rgb(static_cast<float>(sum[0].value() / n), static_cast<float>(sum[1].value() / n),
             static_cast<float>(sum[2].value() / n));
}

double Film::mean_luminance(std::size_t pixel) const {
  const ExactSum* sum = sums_[pixel].rgb;
  return luminance_of(sum[0].value(), sum[1].value(), sum[2].value()) / samples_[pixel];
}

double Film::variance_of_mean(std::size_t pixel) const {
  if (samples_[pixel] < 2) return 0.0;
  const double n = samples_[pixel];
  const double mean = mean_luminance(pixel);
  const double squared_deviations = sums_[pixel].luminance_squared.value() - n * mean * mean;
  return std::max(0.0, squared_deviations) / (n - 1.0) / n;
}

double Film::variance_of_mean(int x, int y) const { return variance_of_mean(index(x, y)); }

double Film::estimated_relmse() const {
  double total = 0.0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (samples_[i] < 2) continue;
    const double mean = mean_luminance(i);
    total += variance_of_mean(i) / (mean * mean + 0.01);
    ++pixels;
  }
  return pixels == 0 ? std::numeric_limits<double>::infinity() : total / static_cast<double>(pixels);
}

Image Film::image() const {
  Image picture(width_, height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) picture.at(x, y) = mean(x, y);
  }
  return picture;
}

void Film::add(const Film& other, int x, int y) {
  RAYLAB_CHECK(x >= 0 && y >= 0 && other.width_ <= width_ - x && other.height_ <= height_ - y);
  for (int row = 0; row < other.height_; ++row) {
    for (int column = 0; column < other.width_; ++column) {
      const std::size_t from = other.index(column, row);
      const std::size_t to = index(x + column, y + row);
      for (int c = 0; c < 3; ++c) sums_[to].rgb[c].add(other.sums_[from].rgb[c]);
      sums_[to].luminance_squared.add(other.sums_[from].luminance_squared);
      samples_[to] += other.samples_[from];
    }
  }
}

void Film::clear() {
  std::fill(sums_.begin(), sums_.end(), PixelSum{});
  std::fill(samples_.begin(), samples_.end(), 0u);
}

}  // namespace raylab
