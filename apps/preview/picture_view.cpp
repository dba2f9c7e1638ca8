#include "picture_view.hpp"

#include <algorithm>

#include "shaders.hpp"

namespace raylab {

PictureView::PictureView() : program_("picture", shaders::kScreenVertex, shaders::kPictureFragment) {
  const std::vector<std::uint8_t> black(3, 0);
  for (const GlTexture* texture : {&left_, &right_}) upload(*texture, 1, 1, black);
}

void PictureView::upload(const GlTexture& texture, int width, int height, const std::vector<std::uint8_t>& srgb) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE, srgb.data());
  // Nearest: a pixel of the picture is a pixel of the window, and of a coarse picture a visible block.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
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

}  // namespace raylab
