#pragma once
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

/// Bilinear look-up with repeat; texel centres at half-integers; v upwards.
Rgb sample_image(const TextureImage& image, const vec2& uv);

}  // namespace raylab
