#include "gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace raylab {
namespace {

GltfAffine operator*(const GltfAffine& a, const GltfAffine& b) {
  return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

glm::dmat3 rotation(const std::vector<double>& quaternion) {
  const double length = std::hypot(std::hypot(quaternion[0], quaternion[1]), std::hypot(quaternion[2], quaternion[3]));
  if (!(length > 0.0)) return glm::dmat3(1.0);
  const dvec3 v = dvec3(quaternion[0], quaternion[1], quaternion[2]) / length;
  const double w = quaternion[3] / length;
  glm::dmat3 result;
  for (int i = 0; i < 3; ++i) {
    dvec3 axis(0.0);
    axis[i] = 1.0;
    const dvec3 t = 2.0 * glm::cross(v, axis);
    result[i] = axis + w * t + glm::cross(v, t);
  }
  return result;
}

GltfAffine local(const tinygltf::Node& node, const std::string& what, GltfDocument& document) {
  const auto check = [&](const std::vector<double>& values, std::size_t count, const char* name) {
    if (values.empty() || values.size() == count) return !values.empty();
    document.fail(what + ": found a " + name + " of " + std::to_string(values.size()) + " numbers, expected " +
                  std::to_string(count));
  };
  GltfAffine result;
  if (check(node.matrix, 16, "matrix")) {
    const auto& m = node.matrix;
    for (std::size_t i = 0; i < 3; ++i) {
      result.linear[static_cast<int>(i)] = {m[4 * i], m[4 * i + 1], m[4 * i + 2]};
    }
    result.translation = {m[12], m[13], m[14]};
    if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
      document.warn("the last row of matrices that are not affine is left out");
    }
    return result;
  }
  if (check(node.rotation, 4, "rotation")) result.linear = rotation(node.rotation);
  if (check(node.scale, 3, "scale")) {
    for (int i = 0; i < 3; ++i) result.linear[i] *= node.scale[static_cast<std::size_t>(i)];
  }
  if (check(node.translation, 3, "translation")) {
    result.translation = {node.translation[0], node.translation[1], node.translation[2]};
  }
  return result;
}

std::vector<int> roots(GltfDocument& document) {
  const auto& model = document.model();
  const int scene = model.defaultScene;
  if (scene != -1) {
    if (scene < 0 || static_cast<std::size_t>(scene) >= model.scenes.size()) {
      document.fail("there is no scene " + std::to_string(scene));
    }
    if (model.scenes.size() > 1) document.warn("scenes other than the default one are left out");
    return model.scenes[static_cast<std::size_t>(scene)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      const auto at = static_cast<std::size_t>(child);  // a negative one is beyond the end
      if (at < is_child.size()) is_child[at] = true;
    }
  }
  std::vector<int> result;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) result.push_back(static_cast<int>(i));
  }
  if (result.empty()) document.fail("every node is a child: nodes form no trees");
  return result;
}

}  // namespace

std::vector<GltfMeshUse> mesh_uses(GltfDocument& document) {
  const auto& model = document.model();
  std::vector<GltfMeshUse> uses;
  if (model.nodes.empty()) {
    for (std::size_t i = 0; i < model.meshes.size(); ++i) uses.push_back({static_cast<int>(i), {}});
    return uses;
  }
  // Without recursion, as trees may be deep.
  struct Visit {
    int node;
    GltfAffine parent;
  };
  std::vector<Visit> open;
  const auto push = [&](const std::vector<int>& nodes, const GltfAffine& parent) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) open.push_back({*node, parent});
  };
  push(roots(document), {});
  std::vector<bool> reached(model.nodes.size());
  while (!open.empty()) {
    const auto [index, parent] = open.back();
    open.pop_back();
    const std::string what = "node " + std::to_string(index);
    const auto at = static_cast<std::size_t>(index);  // a negative one is beyond the end
    if (at >= model.nodes.size()) document.fail("there is no " + what);
    if (reached[at]) document.fail(what + " is reached twice: nodes form no trees");
    reached[at] = true;
    const tinygltf::Node& node = model.nodes[at];
    const GltfAffine to_world = parent * local(node, what, document);
    if (node.mesh != -1) uses.push_back({node.mesh, to_world});
    push(node.children, to_world);
  }
  return uses;
}

}  // namespace raylab
