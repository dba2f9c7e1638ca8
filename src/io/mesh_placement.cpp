#include "mesh_placement.hpp"

#include <utility>

#include "core/angle.hpp"
#include "geometry/smooth_normals.hpp"

namespace raylab {
namespace {

constexpr Numbers kDegrees = {"an angle in degrees, from 0 to 180", [](float x) { return x >= 0.0f && x <= 180.0f; }};

/// Anticlockwise by `degrees`, seen from the tip of a unit axis (Rodrigues).
glm::dmat3 rotation(const dvec3& axis, float degrees) {
  const SineCosine turn = sine_cosine_of_degrees(static_cast<double>(degrees));
  const auto turned = [&](const dvec3& v) {
    const dvec3 along = glm::dot(axis, v) * axis;
    return along + turn.cosine * (v - along) + turn.sine * glm::cross(axis, v);
  };
  return {turned({1.0, 0.0, 0.0}), turned({0.0, 1.0, 0.0}), turned({0.0, 0.0, 1.0})};
}

glm::dmat3 scaling(const dvec3& s) { return {dvec3(s.x, 0, 0), dvec3(0, s.y, 0), dvec3(0, 0, s.z)}; }

dvec3 scale_of(const TomlValue& value, const std::string& path) {
  if (!value.is_array()) return dvec3(static_cast<double>(number_of(value, path, kPositive)));
  const Numbers not_zero = {"a finite number that is not 0", [](float x) { return x != 0.0f; }};
  return dvec3(vec3_of(value, path, not_zero));
}

glm::dmat3 up_axis(const TomlValue& value, const std::string& path) {
  const std::string& axis = string_of(value, path);
  if (axis == "x") return {dvec3(0, 1, 0), dvec3(-1, 0, 0), dvec3(0, 0, 1)};
  if (axis == "z") return {dvec3(1, 0, 0), dvec3(0, 0, -1), dvec3(0, 1, 0)};
  if (axis != "y") value.fail(path, "the axis of the file that points up: \"x\", \"y\" or \"z\"");
  return glm::dmat3(1.0);
}

}  // namespace

MeshPlacement::Step MeshPlacement::read_step(const TomlValue& value, const std::string& path) {
  TableReader reader(value, path);
  Step step;
  int found = 0;
  if (const TomlValue* scale = reader.find("scale")) {
    ++found;
    step.linear = scaling(scale_of(*scale, reader.path_of("scale")));
  }
  for (int axis = 0; axis < 3; ++axis) {
    float degrees = 0.0f;
    if (!reader.number(std::string("rotate_") + "xyz"[axis], degrees, kAnyNumber)) continue;
    ++found;
    dvec3 unit(0.0);
    unit[axis] = 1.0;
    step.linear = rotation(unit, degrees);
  }
  if (const TomlValue* rotate = reader.find("rotate")) {
    ++found;
    TableReader turn(*rotate, reader.path_of("rotate"));
    float degrees = 0.0f;
    turn.number("degrees", degrees, kAnyNumber);
    const TomlValue& axis = turn.require("axis");
    turn.require("degrees");
    turn.finish();
    const vec3 direction = vec3_of(axis, turn.path_of("axis"), kAnyNumber);
    if (direction == vec3(0.0f)) axis.fail(turn.path_of("axis"), "an axis that is not [0, 0, 0]");
    step.linear = rotation(glm::normalize(dvec3(direction)), degrees);
  }
  if (const TomlValue* translate = reader.find("translate")) {
    ++found;
    step.offset = dvec3_of(*translate, reader.path_of("translate"));
  }
  reader.finish();
  if (found != 1) {
    value.fail_here(path + ": expected one of scale, rotate_x, rotate_y, rotate_z, rotate, translate in each step");
  }
  return step;
}

MeshPlacement MeshPlacement::read(TableReader& reader, const dvec3& origin) {
  MeshPlacement placement;
  if (const TomlValue* up = reader.find("up")) placement.steps_.push_back({up_axis(*up, reader.path_of("up"))});
  const TomlValue* transform = reader.find("transform");
  const TomlValue* scale = reader.find("scale");
  float rotate_y = 0.0f;
  const bool rotates = reader.number("rotate_y", rotate_y, kAnyNumber);
  const TomlValue* translate = reader.find("translate");
  if (transform != nullptr) {
    const std::string path = reader.path_of("transform");
    if (scale != nullptr || rotates || translate != nullptr) {
      transform->fail_here(path + ": expected no scale, rotate_y or translate beside it: they are steps of it");
    }
    if (!transform->is_array()) transform->fail(path, "steps in order, such as [{ scale = 2 }, { rotate_x = 90 }]");
    for (std::size_t i = 0; i < transform->items.size(); ++i) {
      placement.steps_.push_back(read_step(transform->items[i], path + "." + std::to_string(i)));
    }
  }
  if (scale != nullptr) placement.steps_.push_back({scaling(scale_of(*scale, reader.path_of("scale")))});
  if (rotates) placement.steps_.push_back({rotation({0.0, 1.0, 0.0}, rotate_y)});
  if (translate != nullptr) {
    placement.steps_.push_back({glm::dmat3(1.0), dvec3_of(*translate, reader.path_of("translate"))});
  }
  placement.steps_.push_back({glm::dmat3(1.0), -origin});
  std::erase_if(placement.steps_,
                [](const Step& step) { return step.linear == glm::dmat3(1.0) && step.offset == dvec3(0.0); });
  float degrees = 0.0f;
  if (reader.number("smooth", degrees, kDegrees)) placement.smooth_ = degrees;
  reader.boolean("flip_v", placement.flip_v_);
  return placement;
}

void MeshPlacement::move(TriangleMesh& mesh, const TomlValue& table, const std::string& name) const {
  for (vec3& p : mesh.positions) {
    dvec3 moved(p);
    for (const Step& step : steps_) moved = step.linear * moved + step.offset;
    p = vec3(moved);
    if (!is_finite(p)) table.fail_here("mesh " + name + ": a vertex is too far away once scaled and moved");
  }
  glm::dmat3 linear(1.0);
  for (const Step& step : steps_) linear = step.linear * linear;
  if (linear == glm::dmat3(1.0)) return;
  const bool mirrored = glm::determinant(linear) < 0.0;
  // Normals stay perpendicular to surfaces by the inverse transpose, which is the matrix of cofactors divided by the
  // determinant: lengths do not matter, its sign does.
  const glm::dmat3 cofactors = {glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                glm::cross(linear[0], linear[1])};
  const double sign = mirrored ? -1.0 : 1.0;
  for (vec3& n : mesh.normals) n = vec3(glm::normalize(sign * (cofactors * dvec3(n))));
  if (!mirrored) return;
  for (std::vector<uvec3>* indices : {&mesh.triangles, &mesh.normal_indices, &mesh.texcoord_indices}) {
    for (uvec3& corners : *indices) std::swap(corners.y, corners.z);
  }
}

void MeshPlacement::apply(TriangleMesh& mesh, const TomlValue& table, const std::string& name) const {
  if (!steps_.empty()) move(mesh, table, name);
  if (flip_v_) {
    for (vec2& uv : mesh.texcoords) uv.y = 1.0f - uv.y;
  }
  if (smooth_) smooth_normals(mesh, *smooth_);
}

}  // namespace raylab
