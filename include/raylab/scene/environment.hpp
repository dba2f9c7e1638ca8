#pragma once
#include <cstdint>
#include <vector>

#include "raylab/core/vec.hpp"
#include "raylab/scene/texture.hpp"

namespace raylab {

/// Radiance that arrives from outside the scene.
struct Environment {
  enum class Kind : std::uint8_t {
    constant,  ///< `bottom` from everywhere
    gradient,  ///< from `bottom` below to `top` above, linear in the height of the unit direction
    image,     ///< latitude-longitude picture: top row is +y, u = 0.5 looks along -z
  };
  Kind kind = Kind::constant;
  Rgb bottom = Rgb(0.0f);
  Rgb top = Rgb(0.0f);
  TextureImage picture;

  bool is_black() const;

  /// Radiance from unit direction d (pointing away from the scene).
  Rgb radiance(const vec3& d) const;

  /// Mean luminance over the sphere of directions.
  float mean_luminance() const;
};

/// Chooses directions in proportion to the luminance of an environment; for the image kind a piecewise constant
/// density over its texels, else uniform. pbrt-v4 §A.5.
class EnvironmentSampler {
 public:
  EnvironmentSampler() = default;
  explicit EnvironmentSampler(const Environment& environment);

  struct Sample {
    vec3 direction;  ///< unit
    float pdf;       ///< per steradian; 0 where rounding has put the direction on a pole or into a black texel
  };
  Sample sample(const vec2& u) const;
  /// Density per steradian with which sample() gives unit direction d.
  float pdf(const vec3& d) const;

  std::size_t bytes() const;

 private:
  int width_ = 0, height_ = 0;     // 0: uniform
  std::vector<float> row_cdf_;     // height + 1
  std::vector<float> column_cdf_;  // height * (width + 1)
  std::vector<float> density_;     // per texel, relative to the unit square; height * width
};

/// Position in the picture, u and v in [0, 1], v from the top, of unit direction d, and back.
vec2 direction_to_latlong(const vec3& d);
vec3 latlong_to_direction(const vec2& uv);

}  // namespace raylab
