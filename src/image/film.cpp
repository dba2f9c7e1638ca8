#include "raylab/image/film.hpp"

#include <bit>

#include "raylab/core/check.hpp"
#include "raylab/image/film_error.hpp"

namespace raylab {

namespace {

std::size_t pixel_count(int width, int height) {
  RAYLAB_CHECK(width > 0 && height > 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// Below this, numbers and their squares are cut to integers of 64 bits at once, which is nearly always.
constexpr float kRootOfSmall = 16.0f;
static_assert(kRootOfSmall * kRootOfSmall <= ExactSum::kSmall);

bool all_small(const float* numbers, std::size_t count) {
  int large = 0;
  for (std::size_t i = 0; i < count; ++i) large |= static_cast<int>(!(numbers[i] < kRootOfSmall));
  return large == 0;
}

void add_numbers(const float* numbers, std::size_t count, ExactSum& sum) {
  ExactSum all = sum;
  if (all_small(numbers, count)) {
    for (std::size_t i = 0; i < count; ++i) all.add_small(numbers[i]);
  } else {
    for (std::size_t i = 0; i < count; ++i) all.add(numbers[i]);
  }
  sum = all;
}

}  // namespace

/// Squared in double: the variance of equal samples must not drown in the rounding of their squares.
void SquareSum::add(const float* numbers, std::size_t count) {
  constexpr double kScale = static_cast<double>(std::int64_t{1} << kFractionBits);
  constexpr double kMost = 0x1p96;  // of one square: more than the sum holds, and 2^32 of them fit 128 bits
  unsigned __int128 sum = bits();
  if (all_small(numbers, count)) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      sum += static_cast<std::uint64_t>(static_cast<std::int64_t>(x * x * kScale));
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      sum += static_cast<unsigned __int128>(std::min(x * x * kScale, kMost));
    }
  }
  set(sum);
}

void OctaveSum::set(std::uint32_t octave, const std::array<std::uint64_t, 3>& units) {
  auto bits = static_cast<unsigned __int128>(octave) << 81;
  for (std::size_t c = 0; c < 3; ++c) {
    bits |= static_cast<unsigned __int128>(std::min<std::uint64_t>(units[c], kMost)) << (27 * c);
  }
  *this = from_bits(bits);
}

void OctaveSum::add(const std::array<const float*, 3>& radiance, std::size_t count, std::uint32_t first) {
  if (count == 0) return;
  const auto octave_now = static_cast<std::uint32_t>(std::bit_width(first + static_cast<std::uint32_t>(count) - 1));
  if (octave_now < octave()) return;
  const bool goes_on = octave_now == octave();
  const std::uint32_t start = octave_now == 0 ? 0 : 1u << (octave_now - 1);
  const std::size_t skipped = first < start ? start - first : 0;
  std::array<std::uint64_t, 3> sums;
  for (std::size_t c = 0; c < 3; ++c) {
    std::uint64_t sum = goes_on ? units(c) : 0;
    for (std::size_t i = skipped; i < count; ++i) {
      // Cut after an offset that is spread evenly over the samples, so that dark ones do not vanish.
      const std::uint32_t spread = (first + static_cast<std::uint32_t>(i)) * 0x9e3779b9u;
      const float offset = static_cast<float>(static_cast<std::int32_t>(spread >> 8)) * 0x1p-24f;
      sum += static_cast<std::uint32_t>(
          static_cast<std::int32_t>(std::min(radiance[c][i], 0x1p20f) * static_cast<float>(1.0 / kUnit) + offset));
    }
    sums[c] = sum;
  }
  set(octave_now, sums);
}

void OctaveSum::add(const OctaveSum& other) {
  if (other.octave() < octave()) return;
  if (other.octave() > octave()) {
    *this = other;
    return;
  }
  std::array<std::uint64_t, 3> sums;
  for (std::size_t c = 0; c < 3; ++c) sums[c] = std::uint64_t{units(c)} + other.units(c);
  set(octave(), sums);
}

Film::Film(int width, int height)
    : width_(width),
      height_(height),
      sums_(pixel_count(width, height)),
      squares_(sums_.size()),
      octaves_(sums_.size()),
      taken_(sums_.size()) {}

void Film::add(int x, int y, const std::array<const float*, 3>& radiance, std::size_t count, std::uint32_t first) {
  const std::size_t i = index(x, y);
  for (std::size_t c = 0; c < 3; ++c) {
    add_numbers(radiance[c], count, sums_[i][c]);
    squares_[i][c].add(radiance[c], count);
  }
  octaves_[i].add(radiance, count, first);
  taken_[i] += static_cast<std::uint32_t>(count);
}

void Film::drop(std::size_t pixel, std::uint32_t count) {
  if (count == 0) return;
  if (dropped_.empty()) dropped_.resize(taken_.size());
  taken_[pixel] += count;
  dropped_[pixel] += count;
}

Rgb Film::mean(int x, int y) const {
  const std::size_t i = index(x, y);
  return kept(i) == 0 ? Rgb(0.0f) : Rgb(mean(i));
}

dvec3 Film::mean(std::size_t pixel) const {
  const auto& sum = sums_[pixel];
  return dvec3(sum[0].value(), sum[1].value(), sum[2].value()) / static_cast<double>(kept(pixel));
}

dvec3 Film::variance_of_mean(int x, int y) const {
  const std::size_t pixel = index(x, y);
  if (kept(pixel) < 2) return dvec3(0.0);
  const double n = kept(pixel);
  const dvec3 m = mean(pixel);
  dvec3 squared_deviations;
  for (int c = 0; c < 3; ++c) {
    const SquareSum& squares = squares_[pixel][static_cast<std::size_t>(c)];
    squared_deviations[c] = (squares.is_full() ? n * n * m[c] * m[c] : squares.value()) - n * m[c] * m[c];
  }
  return glm::max(squared_deviations, dvec3(0.0)) / (n - 1.0) / n;
}

bool Film::variance_is_bound(int x, int y) const {
  const auto& squares = squares_[index(x, y)];
  return squares[0].is_full() || squares[1].is_full() || squares[2].is_full();
}

std::optional<dvec3> Film::octave_variance(int x, int y) const {
  const std::size_t pixel = index(x, y);
  const std::uint32_t n = kept(pixel);
  const OctaveSum& octave = octaves_[pixel];
  if (n < 2 || n != taken_[pixel] || octave.octave() != static_cast<std::uint32_t>(std::bit_width(n - 1))) return {};
  const double before = 1u << (octave.octave() - 1), after = n - before;
  dvec3 variance;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t units = octave.units(static_cast<std::size_t>(c));
    if (units == OctaveSum::kMost) return {};
    const double late = units * OctaveSum::kUnit;
    const double early = sums_[pixel][static_cast<std::size_t>(c)].value() - late;
    const double difference = late / after - early / before;
    variance[c] = difference * difference * before * after / n / n;
  }
  return variance;
}

double Film::estimated_relmse() const { return estimate_relmse(*this, false).relmse; }

Image Film::image() const {
  Image picture(width_, height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) picture.at(x, y) = mean(x, y);
  }
  return picture;
}

Film Film::rows(int first, int count) const {
  RAYLAB_CHECK(first >= 0 && count > 0 && count <= height_ - first);
  Film part(width_, count);
  const auto copy = [&](const auto& from, auto& to) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(index(0, first)), to.size(), to.begin());
  };
  copy(sums_, part.sums_);
  copy(squares_, part.squares_);
  copy(octaves_, part.octaves_);
  for (std::size_t i = 0; i < part.taken_.size(); ++i) {
    const std::size_t pixel = index(0, first) + i;
    part.taken_[i] = kept(pixel);
    part.drop(i, taken_[pixel] - kept(pixel));
  }
  return part;
}

void Film::add(const Film& other, int x, int y) {
  RAYLAB_CHECK(x >= 0 && y >= 0 && other.width_ <= width_ - x && other.height_ <= height_ - y);
  for (int row = 0; row < other.height_; ++row) {
    for (int column = 0; column < other.width_; ++column) {
      const std::size_t from = other.index(column, row);
      const std::size_t to = index(x + column, y + row);
      for (std::size_t c = 0; c < 3; ++c) {
        sums_[to][c].add(other.sums_[from][c]);
        squares_[to][c].add(other.squares_[from][c]);
      }
      octaves_[to].add(other.octaves_[from]);
      taken_[to] += other.kept(from);
      drop(to, other.taken_[from] - other.kept(from));
    }
  }
}

void Film::clear() { *this = Film(width_, height_); }

void Film::row_words(int y, std::uint32_t* words) const {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t pixel = index(0, y) + x;
    std::uint32_t* word = words + x;
    const auto put = [&](unsigned __int128 bits, int count) {
      for (int i = 0; i < count; ++i, word += width) *word = static_cast<std::uint32_t>(bits >> (32 * i));
    };
    put(kept(pixel), 1);
    put(octaves_[pixel].bits(), 3);
    for (std::size_t c = 3; c-- > 0;) put(squares_[pixel][c].bits(), 3);
    for (std::size_t c = 3; c-- > 0;) put(sums_[pixel][c].bits(), 4);
    put(taken_[pixel], 1);
  }
}

void Film::add_row_words(int y, const std::uint32_t* words) {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t pixel = index(0, y) + x;
    const std::uint32_t* word = words + x;
    const auto take = [&](int count) {
      unsigned __int128 bits = 0;
      for (int i = 0; i < count; ++i, word += width) bits |= static_cast<unsigned __int128>(*word) << (32 * i);
      return bits;
    };
    const auto more_kept = static_cast<std::uint32_t>(take(1));
    octaves_[pixel].add(OctaveSum::from_bits(take(3)));
    for (std::size_t c = 3; c-- > 0;) {
      SquareSum squares;
      squares.set(take(3));
      squares_[pixel][c].add(squares);
    }
    for (std::size_t c = 3; c-- > 0;) sums_[pixel][c].add(ExactSum::from_bits(take(4)));
    const auto more_taken = static_cast<std::uint32_t>(take(1));
    taken_[pixel] += more_kept;
    drop(pixel, more_taken - more_kept);
  }
}

}  // namespace raylab
