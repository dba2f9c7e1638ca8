#include "picture_view.hpp"

#include <algorithm>

#include "shaders.hpp"

namespace raylab {

namespace {

// Nearest: a pixel of the picture is a pixel of the window, and of a coarse picture a visible block.
void set_nearest() {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

PictureView::PictureView()
    : program_("picture", shaders::kScreenVertex, shaders::kPictureFragment),
      plane_program_("plane over picture", shaders::kScreenVertex,
                     std::string(shaders::kPlaneColor) + shaders::kPlaneOverFragment) {
  const std::vector<std::uint8_t> black(3, 0);
  for (const GlTexture* texture : {&left_, &right_}) upload(*texture, 1, 1, black);
  set_depths(1, 1, {0.0f});
}

void PictureView::upload(const GlTexture& texture, int width, int height, const std::vector<std::uint8_t>& srgb) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE, srgb.data());
  set_nearest();
}

void PictureView::set_depths(int width, int height, const std::vector<float>& depths) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depths_.id());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, depths.data());
  set_nearest();
}

void PictureView::draw(int width, int height, float divider) {
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  program_.use();
  program_.set("left_picture", 0);
  program_.set("right_picture", 1);
  program_.set("divider", divider);
  program_.set("line", 1.0f / static_cast<float>(std::max(width, 1)));
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, right_.id());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, left_.id());
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void PictureView::draw_plane(float depth) {
  plane_program_.use();
  plane_program_.set("depth_picture", 0);
  plane_program_.set("plane_depth", depth);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depths_.id());
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
}

}  // namespace raylab
