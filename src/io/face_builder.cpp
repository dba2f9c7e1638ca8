#include "face_builder.hpp"

#include <utility>

#include "polygon.hpp"

namespace raylab {

vec3 face_normal(const Triangle& t) {
  const dvec3 normal = glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0));
  const double length = glm::length(normal);
  return length > 0.0 ? vec3(normal / length) : vec3(0.0f, 1.0f, 0.0f);
}

void FaceBuilder::add_normal(const vec3& n, std::size_t place) {
  const double length = glm::length(dvec3(n));
  if (!(length > 0.0)) zero_normals_.add(place);
  mesh_.normals.push_back(length > 0.0 ? vec3(dvec3(n) / length) : vec3(0.0f));
}

void FaceBuilder::add_face(std::span<const Corner> corners, std::size_t place) {
  polygon_.clear();
  for (Corner c : corners) {
    if (c.normal != kNone && mesh_.normals[c.normal] == vec3(0.0f)) c.normal = kNone;
    if (polygon_.empty() || polygon_.back().position != c.position) polygon_.push_back(c);
  }
  while (polygon_.size() > 1 && polygon_.front().position == polygon_.back().position) polygon_.pop_back();
  if (polygon_.size() < 3) {
    degenerate_.add(place);
  } else if (polygon_.size() == 3) {
    add_triangle(polygon_[0], polygon_[1], polygon_[2]);
  } else {
    points_.clear();
    pieces_.clear();
    for (const Corner& c : polygon_) points_.push_back(mesh_.positions[c.position]);
    if (!triangulate(points_, pieces_)) tangled_.add(place);
    for (const auto& piece : pieces_) add_triangle(polygon_[piece[0]], polygon_[piece[1]], polygon_[piece[2]]);
  }
}

void FaceBuilder::finish(std::vector<std::string>& warnings, const std::string& file,
                         const std::function<std::string(std::size_t)>& location) {
  finish_normals();
  finish_texcoords();
  mesh_.pad_positions();
  const auto warn = [&](const Tally& tally, const std::string& what) {
    if (tally.count == 0) return;
    warnings.push_back(location(tally.first) + ": " + what + ": " + std::to_string(tally.count) + ", the first here");
  };
  warn(degenerate_, "faces of fewer than 3 distinct corners, left out");
  warn(tangled_, "polygons that cross themselves or have no area, split as fans");
  warn(zero_normals_, "normals of length zero, replaced by those of the faces");
  if (mesh_.triangles.empty()) warnings.push_back(file + ": no faces");
}

void FaceBuilder::finish_normals() {
  if (normal_indices_.absent()) mesh_.normals = {};
  mesh_.normal_indices = std::move(normal_indices_.indices());
  for (std::uint32_t i = 0; i < mesh_.normal_indices.size(); ++i) {
    uvec3& corners = mesh_.normal_indices[i];
    if (corners.x != kNone && corners.y != kNone && corners.z != kNone) continue;
    const auto own = static_cast<std::uint32_t>(mesh_.normals.size());
    mesh_.normals.push_back(face_normal(triangle_corners(mesh_, i)));
    for (int c = 0; c < 3; ++c) corners[c] = corners[c] == kNone ? own : corners[c];
  }
}

void FaceBuilder::finish_texcoords() {
  if (texcoord_indices_.absent()) mesh_.texcoords = {};
  mesh_.texcoord_indices = std::move(texcoord_indices_.indices());
  const auto origin = static_cast<std::uint32_t>(mesh_.texcoords.size());
  bool needs_origin = false;
  for (uvec3& corners : mesh_.texcoord_indices) {
    for (int c = 0; c < 3; ++c) {
      needs_origin = needs_origin || corners[c] == kNone;
      corners[c] = corners[c] == kNone ? origin : corners[c];
    }
  }
  if (needs_origin) mesh_.texcoords.emplace_back(0.0f, 0.0f);
}

}  // namespace raylab
