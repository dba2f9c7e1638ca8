#pragma once
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// A picture used as texture: linear RGB, decoded once when loaded.
struct TextureImage {
  std::string name;  ///< the file as named by the scene, for messages
  int width = 0;
  int height = 0;
  std::vector<Rgb> texels;  ///< row by row from the top
  Rgb mean = Rgb(0.0f);
};

/// A colour that may vary over the surface.
struct Texture {
  enum class Kind : std::uint8_t {
    solid,    ///< `a` everywhere
    checker,  ///< `a` where floor(x/size) + floor(y/size) + floor(z/size) is even, else `b`: by world position
    image,    ///< picture `image`, bilinear, repeating, (0,0) at the lower left corner
  };
  Kind kind = Kind::solid;
  std::uint32_t image = 0;
  float size = 1.0f;
  Rgb a = Rgb(1.0f);
  Rgb b = Rgb(0.0f);

  static Texture solid_color(const Rgb& color) {
    Texture t;
    t.a = color;
    return t;
  }
};

/// What a picture shows above its first row and below its last one: on meshes it repeats, on a sphere, whose poles lie
/// there, the row goes on.
enum class AddressMode : std::uint8_t { repeat, clamp };
constexpr AddressMode address_mode_of_v(bool on_sphere) { return on_sphere ? AddressMode::clamp : AddressMode::repeat; }

/// Bilinear look-up, repeating along u; texel centres at half-integers; v upwards.
Rgb sample_image(const TextureImage& image, const vec2& uv, AddressMode mode_of_v = AddressMode::repeat);

/// Colour of the texture at world position p and texture coordinates uv.
inline Rgb texture_color(const Texture& texture, const std::vector<TextureImage>& images, const vec3& p, const vec2& uv,
                         AddressMode mode_of_v = AddressMode::repeat) {
  if (texture.kind == Texture::Kind::solid) return texture.a;
  if (texture.kind == Texture::Kind::image) return sample_image(images[texture.image], uv, mode_of_v);
  const vec3 cell = glm::floor(p / texture.size);
  // Parity in float: cells too large for an integer type are even, and nothing overflows.
  const float sum = cell.x + cell.y + cell.z;
  return sum - 2.0f * std::floor(0.5f * sum) == 0.0f ? texture.a : texture.b;
}

/// Mean luminance over the texture, for choosing among lights.
inline float mean_luminance(const Texture& texture, const std::vector<TextureImage>& images) {
  switch (texture.kind) {
    case Texture::Kind::solid:
      return luminance(texture.a);
    case Texture::Kind::checker:
      return 0.5f * (luminance(texture.a) + luminance(texture.b));
    case Texture::Kind::image:
      return luminance(images[texture.image].mean);
  }
  return 0.0f;
}

}  // namespace raylab
