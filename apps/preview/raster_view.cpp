#include "raster_view.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "raylab/core/timing.hpp"

namespace raylab {

namespace {

// Nearest over farthest distance that is drawn.
constexpr float kDepthRatio = 1e-5f;
// While moving, as many pixels are shaded as can be in this time, but no fewer than make a picture.
constexpr double kMovingSeconds = 0.05;
constexpr double kFewestMovingPixels = 20000.0;
constexpr double kMostMovingPixels = 4e6;

}  // namespace

bool has_clip_control() {
  GLint major = 0, minor = 0, extensions = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor >= 45) return true;
  glGetIntegerv(GL_NUM_EXTENSIONS, &extensions);
  for (GLint i = 0; i < extensions; ++i) {
    const auto* name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (std::string_view(name) == "GL_ARB_clip_control") return true;
  }
  return false;
}

RasterView::Eye RasterView::make_eye(const CameraSettings& settings, int width, int height) const {
  const Camera camera(settings, width, height);
  Eye eye;
  eye.position = camera.origin();
  eye.up = camera.up();
  eye.ahead = camera.forward();
  const float half = std::tan(0.5f * settings.vfov * kPi / 180.0f);
  eye.right = camera.right() * (half * static_cast<float>(width) / static_cast<float>(height));
  eye.above = camera.up() * half;
  float far = settings.focus_distance;
  if (!bounds_.empty()) {
    const vec3 reach = glm::max(glm::abs(bounds_.lower - eye.position), glm::abs(bounds_.upper - eye.position));
    far = std::max(far, glm::length(reach));
  }
  far *= 1.01f;
  const float near = far * kDepthRatio;
  eye.nearest = near;
  // Depth near / t in float tells surfaces apart to 1e-7 of their distance, however near the eye may come. It
  // takes clip control, without which depth goes from 0 at the nearest to 1 at the farthest.
  const float slope = reversed_depth_ ? 0.0f : (far + near) / (far - near);
  const float offset = reversed_depth_ ? near : -2.0f * far * near / (far - near);
  eye.depth = reversed_depth_ ? vec2(0.0f, near) : vec2(0.5f * slope + 0.5f, 0.5f * offset);
  // Rows of the view, divided by how far right and above reach.
  const vec3 x = eye.right / glm::dot(eye.right, eye.right);
  const vec3 y = eye.above / glm::dot(eye.above, eye.above);
  const vec3 z = eye.ahead * slope;
  const vec3 w = eye.ahead;
  eye.clip_from_view = glm::mat4(x.x, y.x, z.x, w.x, x.y, y.y, z.y, w.y, x.z, y.z, z.z, w.z, 0.0f, 0.0f, offset, 0.0f);
  return eye;
}

void RasterView::resize_target(int width, int height) {
  if (width == target_width_ && height == target_height_) return;
  target_width_ = width;
  target_height_ = height;
  glBindRenderbuffer(GL_RENDERBUFFER, target_color_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, target_depth_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.id());
  glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target_color_.id());
  glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target_depth_.id());
}

void RasterView::set_common(const GlProgram& program, const Eye& eye, int width, int height) const {
  program.use();
  program.set("clip_from_view", eye.clip_from_view);
  program.set("eye", eye.position);
  program.set("up", eye.up);
  program.set("ahead", eye.ahead);
  program.set("right", eye.right);
  program.set("above", eye.above);
  program.set("size", vec2(width, height));
  program.set("nearest", eye.nearest);
  program.set("depth", eye.depth);
  program.set("materials", 0);
  program.set("picture", 1);
  program.set("sky_picture", 2);
  program.set("sky_kind", static_cast<int>(sky_kind_));
  program.set("sky_bottom", sky_bottom_);
  program.set("sky_top", sky_top_);
}

void RasterView::draw_meshes(bool coarse, bool glass) {
  glBindVertexArray(mesh_array_.id());
  mesh_program_.use();
  for (const RasterDraw& draw : coarse ? coarse_ : full_) {
    if (is_glass_[draw.material] != glass || draw.count == 0) continue;
    glBindTexture(GL_TEXTURE_2D, textures_[texture_of_[draw.material]].id());
    mesh_program_.set("material", static_cast<int>(draw.material));
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::size_t{draw.first} * sizeof(std::uint32_t)));
    triangles_drawn_ += draw.count / 3;
  }
}

void RasterView::draw_spheres(bool glass) {
  glBindVertexArray(sphere_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, sphere_buffer_.id());
  sphere_program_.use();
  constexpr GLsizei stride = sizeof(Sphere) + sizeof(std::int32_t);
  for (const SphereDraw& draw : sphere_draws_) {
    if (draw.glass != glass) continue;
    glBindTexture(GL_TEXTURE_2D, textures_[draw.texture].id());
    // OpenGL 3.3 has no first instance: the pointers say where to start.
    const std::size_t start = std::size_t{draw.first} * stride;
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, stride, reinterpret_cast<const void*>(start));
    glVertexAttribIPointer(1, 1, GL_INT, stride, reinterpret_cast<const void*>(start + sizeof(Sphere)));
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(draw.count));
  }
}

void RasterView::draw_scene(const Eye& eye, int width, int height, const Options& options) {
  for (const GlProgram* program : {&mesh_program_, &sphere_program_, &sky_program_, &plane_program_}) {
    set_common(*program, eye, width, height);
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_BUFFER, material_texture_.id());
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, textures_.back().id());
  glActiveTexture(GL_TEXTURE1);

  glViewport(0, 0, width, height);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  if (reversed_depth_) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glClearDepth(reversed_depth_ ? 0.0 : 1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(empty_array_.id());
  sky_program_.use();
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glEnable(GL_DEPTH_TEST);
  glDepthFunc(reversed_depth_ ? GL_GEQUAL : GL_LEQUAL);
  draw_meshes(options.moving, false);
  draw_spheres(false);

  // Of glass only the nearest layer is blended: first its depth, then its colour where that depth is met.
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_meshes(options.moving, true);
  draw_spheres(true);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  draw_meshes(options.moving, true);
  draw_spheres(true);

  if (options.focus_plane) {
    glBindVertexArray(empty_array_.id());
    plane_program_.use();
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  if (reversed_depth_) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

void RasterView::draw_in_time(const Eye& eye, int width, int height, const Options& options) {
  const Stopwatch watch;
  draw_scene(eye, width, height, options);
  if (options.moving) {
    glFinish();  // or the time would be that of writing the commands down
    const double change = std::clamp(kMovingSeconds / std::max(watch.seconds(), 1e-4), 0.5, 1.25);
    moving_pixels_ = std::clamp(std::min(moving_pixels_, static_cast<double>(width) * height) * change,
                                kFewestMovingPixels, kMostMovingPixels);
  }
}

void RasterView::draw(const CameraSettings& camera, int width, int height, const Options& options) {
  const double pixels = static_cast<double>(width) * height;
  const double scale = options.moving ? std::min(1.0, std::sqrt(moving_pixels_ / pixels)) : 1.0;
  const int w = std::max(1, static_cast<int>(width * scale));
  const int h = std::max(1, static_cast<int>(height * scale));
  GLint window = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &window);
  // A still picture is drawn once: a large scene takes a second in software, and nothing of it changes.
  const Drawn now{camera.look_from, camera.look_at,      camera.up,     camera.vfov, camera.focus_distance, width,
                  height,           options.focus_plane, options.moving};
  if (options.moving || drawn_ != now) {
    drawn_ = now;
    resize_target(w, h);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.id());
    triangles_drawn_ = 0;
    plane_program_.use();
    plane_program_.set("distance", camera.focus_distance);
    draw_in_time(make_eye(camera, width, height), w, h, options);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(window));
  glBlitFramebuffer(0, 0, w, h, 0, 0, width, height, GL_COLOR_BUFFER_BIT, w == width ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(window));
}

}  // namespace raylab
