#pragma once
#include "core/warp.hpp"
#include "raylab/scene/camera.hpp"

namespace raylab {
namespace {

/// Camera::ray() over the number type F.
template <class F>
void camera_ray(const Camera::Rays& camera, const F& x, const F& y, const Vec2<F>& lens, Vec3<F>& origin,
                Vec3<F>& direction) {
  if (camera.narrow) {
    using D = DoubleOf<F>;
    const auto exact = [](const dvec3& v) { return Vec3<D>(D(v.x), D(v.y), D(v.z)); };
    direction =
        to_float(exact(camera.exact.corner) + D(x) * exact(camera.exact.step_x) + D(y) * exact(camera.exact.step_y));
  } else {
    direction = Vec3<F>(camera.corner) + x * Vec3<F>(camera.step_x) + y * Vec3<F>(camera.step_y);
  }
  origin = Vec3<F>(camera.origin);
  if (!camera.has_lens) return;
  F disk_x, disk_y;
  concentric_disk<F>(lens.x, lens.y, disk_x, disk_y);
  const Vec3<F> shift = disk_x * Vec3<F>(camera.lens_x) + disk_y * Vec3<F>(camera.lens_y);
  origin = origin + shift;
  direction = direction - shift;
}

}  // namespace
}  // namespace raylab
