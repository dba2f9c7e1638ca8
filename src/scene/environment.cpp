#include "raylab/scene/environment.hpp"

#include <algorithm>
#include <cmath>

#include "core/warp.hpp"

namespace raylab {

namespace {

/// Sine of the angle between the vertical and the middle of a row of a picture.
float sine_of_row(int y, int height) {
  float sine, cosine;
  sine_cosine_of_turn(0.5f * (static_cast<float>(y) + 0.5f) / static_cast<float>(height), sine, cosine);
  return sine;
}

/// Sine of the angle between unit direction d and the vertical.
float sine_from_pole(const vec3& d) { return std::sqrt(d.x * d.x + d.z * d.z); }

}  // namespace

vec2 direction_to_latlong(const vec3& d) {
  // u = 0.5 at -z, growing towards +x as seen from inside.
  const float u = 0.5f + arc_tangent<float>(d.x, -d.z) * (0.5f * kInvPi);
  // Not by the arc cosine, which knows angles below 3e-4 from a pole as 0.
  const float v = arc_tangent<float>(sine_from_pole(d), d.y) * kInvPi;
  return {u, v};
}

vec3 latlong_to_direction(const vec2& uv) {
  float sine_phi, cosine_phi, sine_theta, cosine_theta;  // phi from +z, half a turn from where u = 0.5 looks
  sine_cosine_of_turn(uv.x, sine_phi, cosine_phi);
  sine_cosine_of_turn(0.5f * uv.y, sine_theta, cosine_theta);
  return {-sine_theta * sine_phi, cosine_theta, sine_theta * cosine_phi};
}

bool Environment::is_black() const {
  switch (kind) {
    case Kind::constant:
      return raylab::is_black(bottom);
    case Kind::gradient:
      return raylab::is_black(bottom) && raylab::is_black(top);
    case Kind::image:
      return raylab::is_black(picture.mean);
  }
  return true;
}

Rgb Environment::radiance(const vec3& d) const {
  switch (kind) {
    case Kind::constant:
      return bottom;
    case Kind::gradient: {
      const float a = 0.5f * (d.y + 1.0f);
      return (1.0f - a) * bottom + a * top;
    }
    case Kind::image: {
      // Nearest texel: what the sampler's piecewise constant density follows exactly.
      const vec2 uv = direction_to_latlong(d);
      const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(picture.width)), 0, picture.width - 1);
      const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(picture.height)), 0, picture.height - 1);
      return picture.texels[static_cast<std::size_t>(y) * picture.width + x];
    }
  }
  return Rgb(0.0f);
}

float Environment::mean_luminance() const {
  switch (kind) {
    case Kind::constant:
      return luminance(bottom);
    case Kind::gradient:
      return 0.5f * (luminance(bottom) + luminance(top));
    case Kind::image: {
      double sum = 0.0, weights = 0.0;
      for (int y = 0; y < picture.height; ++y) {
        const double weight = sine_of_row(y, picture.height);
        for (int x = 0; x < picture.width; ++x) {
          sum += weight * luminance(picture.texels[static_cast<std::size_t>(y) * picture.width + x]);
        }
        weights += weight * picture.width;
      }
      return static_cast<float>(sum / weights);
    }
  }
  return 0.0f;
}

namespace {

/// First i with cdf[i + 1] > u, for a rising cdf of n + 1 values from 0 to 1.
int find_interval(const float* cdf, int n, float u) {
  const float* upper = std::upper_bound(cdf + 1, cdf + n, u);
  return static_cast<int>(upper - (cdf + 1));
}

/// Fills cdf (n + 1 values) from weights; all equal where they sum to 0. Returns the sum.
double make_cdf(const float* weights, int n, float* cdf) {
  double total = 0.0;
  for (int i = 0; i < n; ++i) total += weights[i];
  double sum = 0.0;
  cdf[0] = 0.0f;
  for (int i = 0; i < n; ++i) {
    sum += total > 0.0 ? weights[i] / total : 1.0 / n;
    cdf[i + 1] = static_cast<float>(sum);
  }
  cdf[n] = 1.0f;
  return total;
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const Environment& environment) {
  if (environment.kind != Environment::Kind::image) return;
  const TextureImage& picture = environment.picture;
  width_ = picture.width;
  height_ = picture.height;
  row_cdf_.resize(static_cast<std::size_t>(height_) + 1);
  column_cdf_.resize(static_cast<std::size_t>(height_) * (width_ + 1));
  density_.resize(static_cast<std::size_t>(height_) * width_);
  std::vector<float> row_weights(height_);
  for (int y = 0; y < height_; ++y) {
    const float sine = sine_of_row(y, height_);
    float* row = &density_[static_cast<std::size_t>(y) * width_];
    for (int x = 0; x < width_; ++x) {
      row[x] = sine * luminance(picture.texels[static_cast<std::size_t>(y) * width_ + x]);
    }
    row_weights[y] =
        static_cast<float>(make_cdf(row, width_, &column_cdf_[static_cast<std::size_t>(y) * (width_ + 1)]));
  }
  const double total = make_cdf(row_weights.data(), height_, row_cdf_.data());
  // From weights to densities over the unit square: what the two rounded cdfs really do.
  for (int y = 0; y < height_; ++y) {
    const float row_probability = row_cdf_[y + 1] - row_cdf_[y];
    const float* cdf = &column_cdf_[static_cast<std::size_t>(y) * (width_ + 1)];
    for (int x = 0; x < width_; ++x) {
      density_[static_cast<std::size_t>(y) * width_ + x] =
          total > 0.0
              ? row_probability * (cdf[x + 1] - cdf[x]) * static_cast<float>(width_) * static_cast<float>(height_)
              : 1.0f;
    }
  }
}

EnvironmentSampler::Sample EnvironmentSampler::sample(const vec2& u) const {
  if (width_ == 0) {
    const vec3 d = uniform_sphere(u);
    return {{d.x, d.z, d.y}, 0.25f * kInvPi};
  }
  const int y = find_interval(row_cdf_.data(), height_, u.y);
  const float* cdf = &column_cdf_[static_cast<std::size_t>(y) * (width_ + 1)];
  const int x = find_interval(cdf, width_, u.x);
  const auto within = [](const float* c, int i, float v) {
    const float size = c[i + 1] - c[i];
    return size > 0.0f ? std::min((v - c[i]) / size, kOneMinusEpsilon) : 0.5f;
  };
  const vec2 uv((static_cast<float>(x) + within(cdf, x, u.x)) / static_cast<float>(width_),
                (static_cast<float>(y) + within(row_cdf_.data(), y, u.y)) / static_cast<float>(height_));
  const vec3 direction = latlong_to_direction(uv);
  return {direction, pdf(direction)};
}

float EnvironmentSampler::pdf(const vec3& d) const {
  if (width_ == 0) return 0.25f * kInvPi;
  const vec2 uv = direction_to_latlong(d);
  const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(height_)), 0, height_ - 1);
  const float sine = sine_from_pole(d);
  if (sine <= 0.0f) return 0.0f;
  return density_[static_cast<std::size_t>(y) * width_ + x] / (2.0f * kPi * kPi * sine);
}

std::size_t EnvironmentSampler::bytes() const {
  return (row_cdf_.capacity() + column_cdf_.capacity() + density_.capacity()) * sizeof(float);
}

}  // namespace raylab
