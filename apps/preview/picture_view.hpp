#pragma once
#include <cstdint>
#include <vector>

#include "gl.hpp"

namespace raylab {

/// Shows one picture, or two side by side in the same frame.
class PictureView {
 public:
  PictureView();

  /// What is shown: on the left of the divider and on its right; three bytes a pixel, from the upper left.
  void set_left(int width, int height, const std::vector<std::uint8_t>& srgb) { upload(left_, width, height, srgb); }
  void set_right(int width, int height, const std::vector<std::uint8_t>& srgb) { upload(right_, width, height, srgb); }

  /// How far the first surface lies along the view direction, for the focus plane: a number a pixel, from the
  /// upper left.
  void set_depths(int width, int height, const std::vector<float>& depths);

  /// Fills the framebuffer bound for drawing. `divider` in [0, 1] of the width; 1: the left picture alone.
  void draw(int width, int height, float divider);

  /// Draws the focus plane, so far away, over what lies farther.
  void draw_plane(float depth);

 private:
  void upload(const GlTexture& texture, int width, int height, const std::vector<std::uint8_t>& srgb);

  GlProgram program_, plane_program_;
  GlVertexArray array_;
  GlTexture left_, right_, depths_;
};

}  // namespace raylab
