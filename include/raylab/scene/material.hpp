#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "raylab/scene/texture.hpp"

namespace raylab {

/// How a surface scatters or emits: the models of the One Weekend books.
struct Material {
  enum class Kind : std::uint8_t {
    lambertian,     ///< reflects `color` diffusely, both sides
    metal,          ///< mirror direction blurred by a sphere of radius `fuzz`, tinted by `color`
    dielectric,     ///< clear, refractive index `index` relative to the outside, exact Fresnel
    diffuse_light,  ///< emits radiance `color` from both sides, reflects nothing
  };
  std::string name;
  Kind kind = Kind::lambertian;
  Texture color;       ///< albedo in [0, 1], or radiance >= 0 of a light
  float fuzz = 0.0f;   ///< metal, in [0, 1]
  float index = 1.5f;  ///< dielectric, > 0
};

/// What the kinds are called in scene files, in their order.
inline constexpr std::array kMaterialKindNames = {"lambertian", "metal", "dielectric", "diffuse_light"};

}  // namespace raylab
