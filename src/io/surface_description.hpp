#pragma once
#include <string>
#include <vector>

#include "raylab/scene/material.hpp"

namespace raylab {

/// What exporters say of a surface, in the terms that MTL's physically based keys and glTF's metallic-roughness model
/// share. A model that takes all of it would be made from the same description.
struct SurfaceDescription {
  std::string name;
  Texture base_color = Texture::solid_color(Rgb(0.8f));  ///< albedo; of a metal its reflectance; of glass its tint
  float metallic = 0.0f;                                 ///< in [0, 1]
  float roughness = 1.0f;                                ///< in [0, 1]; its square is the width of a GGX lobe
  float transmission = 0.0f;                             ///< in [0, 1]: how much of a dielectric's light goes through
  float index = 1.5f;                                    ///< of refraction, > 0
  Texture emission = Texture::solid_color(Rgb(0.0f));    ///< radiance

  bool is_metal() const { return metallic >= 0.5f; }
  /// Seen only where it is no metal.
  bool is_clear() const { return transmission >= 0.5f; }
};

/// The nearest of the materials there are. What of the description it cannot show is added to `left_out`, each as a
/// phrase such as "its gloss (roughness 0.2)".
/// A surface that emits is a light, one that is metallic from a half on a metal, one that transmits from a half on a
/// dielectric, and any other lambertian.
Material nearest_material(const SurfaceDescription& surface, std::vector<std::string>& left_out);

/// The fuzz with which half of the light of a metal stays within the angle of its mirror direction in which half of
/// that of a GGX lobe of the roughness does, seen straight on; in [0, 1].
float fuzz_of_roughness(float roughness);

}  // namespace raylab
