#pragma once
#include <optional>
#include <vector>

#include "gl.hpp"
#include "raster_geometry.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {

/// Whether depth can be had between 0 and 1 (OpenGL 4.5, or its extension).
bool has_clip_control();

/// The scene as OpenGL draws it: triangles from buffers, spheres as rectangles in which each pixel finds its own
/// hit.
class RasterView {
 public:
  /// Uploads the scene, which is not needed after that. Needs a current OpenGL context.
  explicit RasterView(const Scene& scene);

  struct Options {
    bool moving = false;       ///< fewer triangles and pixels, as many as are drawn in time
    bool focus_plane = false;  ///< drawn translucent at the camera's focus distance
  };

  /// Fills the framebuffer bound for drawing, width x height pixels.
  void draw(const CameraSettings& camera, int width, int height, const Options& options);

  std::size_t triangles_drawn() const { return triangles_drawn_; }  ///< by the last draw, spheres not counted

 private:
  /// What the shaders know of the camera.
  struct Eye {
    vec3 position, up, ahead, right, above;
    glm::mat4 clip_from_view;
    float nearest;
    vec2 depth;  ///< of what is t ahead: x + y / t
  };
  struct SphereDraw {
    std::uint32_t first, count;
    std::uint32_t texture;  ///< index into textures_
    bool glass;
  };

  void upload_meshes(const Scene& scene);
  void upload_spheres(const Scene& scene);
  void upload_materials(const Scene& scene);
  void resize_target(int width, int height);
  Eye make_eye(const CameraSettings& camera, int width, int height) const;
  void set_common(const GlProgram& program, const Eye& eye, int width, int height) const;
  void draw_scene(const Eye& eye, int width, int height, const Options& options);
  void draw_in_time(const Eye& eye, int width, int height, const Options& options);
  void draw_meshes(bool coarse, bool glass);
  void draw_spheres(bool glass);

  GlProgram mesh_program_, sphere_program_, sky_program_, plane_program_;
  GlVertexArray mesh_array_, sphere_array_, empty_array_;
  GlBuffer vertex_buffer_, index_buffer_, sphere_buffer_, material_buffer_;
  GlTexture material_texture_;
  std::vector<GlTexture> textures_;  // those of the scene, then a white one and the sky
  std::vector<RasterDraw> full_, coarse_;
  std::vector<SphereDraw> sphere_draws_;
  std::vector<std::uint32_t> texture_of_;  // of each material
  std::vector<bool> is_glass_;
  Environment::Kind sky_kind_;
  Rgb sky_bottom_, sky_top_;
  Bounds bounds_;

  // Drawn into first: while moving it has fewer pixels than the window.
  GlFramebuffer target_;
  GlRenderbuffer target_color_, target_depth_;
  int target_width_ = 0, target_height_ = 0;
  /// What the last picture showed.
  struct Drawn {
    vec3 from, at, up;
    float vfov, focus_distance;
    int width, height;
    bool focus_plane, moving;
    bool operator==(const Drawn&) const = default;
  };
  std::optional<Drawn> drawn_;
  double moving_pixels_ = 200000.0;
  bool reversed_depth_;
  std::size_t triangles_drawn_ = 0;
};

}  // namespace raylab
