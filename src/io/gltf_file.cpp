#include "gltf_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "face_builder.hpp"
#include "gltf_accessor.hpp"
#include "gltf_document.hpp"
#include "gltf_materials.hpp"
#include "gltf_nodes.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

constexpr std::uint64_t kMostIndices = std::numeric_limits<std::uint32_t>::max();

/// Part of the mesh: a primitive as one node shows it.
struct Piece {
  const tinygltf::Primitive* primitive;
  std::uint32_t transform;  // index
  std::uint32_t first_vertex;
  std::uint32_t vertices;
  bool has_own_vertices;  // and does not share those of a piece before it
  GltfMaterial material;
  std::uint32_t corners;
};

class GltfBuilder {
 public:
  GltfBuilder(MaterialLibrary& library, const std::filesystem::path& file, const ObjOptions& options)
      : library_(library), options_(options), document_(library, file), materials_(library, document_) {}

  MeshWithMaterials build() {
    collect();
    reserve();
    for (const Piece& piece : pieces_) {
      if (piece.has_own_vertices) add_vertices(piece);
      add_triangles(piece);
    }
    if (bad_normals_ > 0) {
      document_.warn("normals of length zero or not finite, replaced by those of the faces: " +
                     std::to_string(bad_normals_));
    }
    if (degenerate_ > 0) {
      document_.warn("triangles of fewer than 3 distinct corners, left out: " + std::to_string(degenerate_));
    }
    if (mesh_.triangles.empty()) document_.warn("no triangles");
    finish_normals();
    mesh_.pad_positions();
    return {std::move(mesh_), finish_materials()};
  }

 private:
  // --- What is to be read -----------------------------------------------------------------------------------

  void collect() {
    for (const GltfMeshUse& use : mesh_uses(document_)) add_mesh(use.mesh, use.to_world);
  }

  void add_mesh(int index, const GltfAffine& to_world) {
    const auto& meshes = document_.model().meshes;
    const std::string what = "mesh " + std::to_string(index);
    if (index < 0 || static_cast<std::size_t>(index) >= meshes.size()) document_.fail("there is no " + what);
    transforms_.push_back(to_world);
    shared_.clear();
    const auto& primitives = meshes[static_cast<std::size_t>(index)].primitives;
    visits_ += primitives.size();
    check_budget();
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      add_primitive(primitives[i], what + ", primitive " + std::to_string(i));
    }
  }

  void add_primitive(const tinygltf::Primitive& primitive, const std::string& what) {
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      document_.fail(what + ": there is no mode " + std::to_string(primitive.mode));
    }
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return document_.warn("points and lines are left out");
    if (!primitive.targets.empty()) document_.warn("morph targets are left out");
    const int position = accessor_of(primitive, "POSITION");
    if (position == -1) return document_.warn("primitives without positions are left out");
    if (primitive.attributes.contains("COLOR_0")) document_.warn("colours of vertices (COLOR_0) are left out");

    Piece piece{};
    piece.primitive = &primitive;
    piece.transform = static_cast<std::uint32_t>(transforms_.size() - 1);
    if (!options_.ignore_materials) piece.material = materials_.get(primitive.material);
    piece.vertices = count_of(position, TINYGLTF_TYPE_VEC3, what + ": POSITION");
    const int normal = accessor_of(primitive, "NORMAL"), texcoord = texcoord_of(piece);
    check_attribute(normal, TINYGLTF_TYPE_VEC3, what + ": NORMAL", piece);
    check_attribute(texcoord, TINYGLTF_TYPE_VEC2, what + ": " + texcoord_name(piece), piece);
    has_normals_ = has_normals_ || normal != -1;
    has_texcoords_ = has_texcoords_ || texcoord != -1;
    piece.corners = primitive.indices == -1 ? piece.vertices
                                            : count_of(primitive.indices, TINYGLTF_TYPE_SCALAR, what + ": indices");

    const bool as_they_are = piece.material.texcoords.rows == GltfTexcoords().rows;
    const std::array key = {position, normal, texcoord, as_they_are ? -1 : primitive.material};
    const auto [first, is_new] = shared_.try_emplace(key, static_cast<std::uint32_t>(vertices_));
    piece.first_vertex = first->second;
    piece.has_own_vertices = is_new;
    if (is_new) vertices_ += piece.vertices;
    triangles_ += triangles_of(piece);
    check_budget();
    pieces_.push_back(piece);
  }

  static int accessor_of(const tinygltf::Primitive& primitive, const std::string& attribute) {
    const auto found = primitive.attributes.find(attribute);
    return found == primitive.attributes.end() ? -1 : found->second;
  }
  static std::string texcoord_name(const Piece& piece) {
    return "TEXCOORD_" + std::to_string(piece.material.texcoords.set);
  }
  static int texcoord_of(const Piece& piece) { return accessor_of(*piece.primitive, texcoord_name(piece)); }

  std::uint32_t count_of(int accessor, int type, const std::string& what) const {
    return static_cast<std::uint32_t>(checked_count(document_, accessor, type, what));
  }

  void check_attribute(int accessor, int type, const std::string& what, const Piece& piece) const {
    if (accessor == -1) return;
    if (const std::uint32_t count = count_of(accessor, type, what); count != piece.vertices) {
      document_.fail(what + ": found " + std::to_string(count) + " elements, expected " +
                     std::to_string(piece.vertices) + " as there are positions");
    }
  }

  static std::uint32_t triangles_of(const Piece& piece) {
    if (piece.primitive->mode == TINYGLTF_MODE_TRIANGLES) return piece.corners / 3;
    return std::max(piece.corners, 2u) - 2;
  }

  /// A triangle may come to have three normals of its own, and indices of them.
  void check_budget() const {
    constexpr std::uint64_t least = std::uint64_t{1} << 26, expansion = 1024;
    constexpr std::uint64_t vertex = 2 * sizeof(vec3) + sizeof(vec2);
    constexpr std::uint64_t triangle = 2 * sizeof(uvec3) + sizeof(vec3) + sizeof(std::uint16_t);
    const std::uint64_t needed = vertex * vertices_ + triangle * triangles_ + sizeof(Piece) * visits_;
    const std::uint64_t budget = std::max(least, expansion * document_.size());
    if (vertices_ < kMostIndices && triangles_ < kMostIndices && needed <= budget) return;
    document_.fail("at least " + std::to_string(visits_) + " primitives of nodes, " + std::to_string(vertices_) +
                   " vertices and " + std::to_string(triangles_) + " triangles exceed this file's budget of " +
                   std::to_string(budget >> 20) + " MiB");
  }

  // --- The mesh ---------------------------------------------------------------------------------------------

  void reserve() {
    mesh_.positions.reserve(vertices_ + 2);  // with what pad_positions() asks for
    if (has_normals_) mesh_.normals.reserve(vertices_);
    if (has_texcoords_) mesh_.texcoords.reserve(vertices_);
    mesh_.triangles.reserve(triangles_);
  }

  void add_vertices(const Piece& piece) {
    const GltfAffine& to_world = transforms_[piece.transform];
    add_positions(accessor_of(*piece.primitive, "POSITION"), to_world);
    if (has_normals_) add_normals(accessor_of(*piece.primitive, "NORMAL"), to_world.linear);
    if (has_texcoords_) add_texcoords(texcoord_of(piece), piece.material.texcoords);
    mesh_.normals.resize(has_normals_ ? mesh_.positions.size() : 0, vec3(0.0f));
    mesh_.texcoords.resize(has_texcoords_ ? mesh_.positions.size() : 0, vec2(0.0f));
  }

  void add_positions(int accessor, const GltfAffine& to_world) {
    const GltfElements elements = elements_of(document_, accessor);
    const std::size_t first = mesh_.positions.size();
    const auto add = [&](const vec3& p) { mesh_.positions.push_back(p); };
    if (to_world == GltfAffine()) {
      for_each_vector<3>(elements, add);
    } else {
      const GltfAffine map = to_world;
      for_each_vector<3>(elements, [&](const vec3& p) { add(vec3(map.linear * dvec3(p) + map.translation)); });
    }
    const auto bad = std::find_if_not(mesh_.positions.begin() + static_cast<std::ptrdiff_t>(first),
                                      mesh_.positions.end(), is_finite);
    if (bad == mesh_.positions.end()) return;
    document_.fail("accessor " + std::to_string(accessor) + ": position " +
                   std::to_string(static_cast<std::size_t>(bad - mesh_.positions.begin()) - first) + " is not finite");
  }

  /// By the cofactors, which are the inverse transpose times the determinant, and exist where there is no inverse. A
  /// normal that has no direction becomes zero.
  void add_normals(int accessor, const glm::dmat3& linear) {
    if (accessor == -1) return;
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    const glm::dmat3 map = is_mirrored(linear) ? -cofactors : cofactors;
    for_each_vector<3>(elements_of(document_, accessor), [&](const vec3& given) {
      const dvec3 n = map * dvec3(given);
      const vec3 normal(n / glm::length(n));
      const bool is_good = is_finite(normal);
      if (!is_good) ++bad_normals_;
      mesh_.normals.push_back(is_good ? normal : vec3(0.0f));
    });
  }

  /// In the file v runs down.
  void add_texcoords(int accessor, const GltfTexcoords& texcoords) {
    if (accessor == -1) return;
    const bool as_they_are = texcoords.rows == GltfTexcoords().rows;
    for_each_vector<2>(elements_of(document_, accessor), [&](const vec2& given) {
      vec2 uv(given.x, 1.0f - given.y);
      if (!as_they_are) {
        const dvec3 from(given.x, given.y, 1.0);
        uv = vec2(static_cast<float>(glm::dot(texcoords.rows[0], from)),
                  static_cast<float>(1.0 - glm::dot(texcoords.rows[1], from)));
      }
      const bool is_good = std::isfinite(uv.x) && std::isfinite(uv.y);
      if (!is_good) document_.warn("texture coordinates that are not finite: (0, 0) in their place");
      mesh_.texcoords.push_back(is_good ? uv : vec2(0.0f));
    });
  }

  static bool is_mirrored(const glm::dmat3& linear) { return glm::determinant(linear) < 0.0; }

  void add_triangles(const Piece& piece) {
    const tinygltf::Primitive& primitive = *piece.primitive;
    if (primitive.indices == -1) {
      add_triangles(piece, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
    } else {
      const GltfElements elements = elements_of(document_, primitive.indices);
      with_indices(elements, [&](const auto& index) {
        std::uint32_t largest = 0;
        for (std::size_t i = 0; i < piece.corners; ++i) largest = std::max(largest, index(i));
        if (piece.corners > 0 && largest >= piece.vertices) {
          document_.fail("accessor " + std::to_string(primitive.indices) + ": found index " + std::to_string(largest) +
                         ", expected below " + std::to_string(piece.vertices) + " as there are positions");
        }
        add_triangles(piece, index);
      });
    }
    if (!runs_.empty() && runs_.back().material == piece.material.index) runs_.pop_back();
    runs_.push_back({mesh_.triangles.size(), piece.material.index});
  }

  template <class Index>
  void add_triangles(const Piece& piece, const Index& index) {
    const int mode = piece.primitive->mode;
    if (mode == TINYGLTF_MODE_TRIANGLES && piece.corners % 3 != 0) {
      document_.warn("corners after the last whole triangle are left out");
    }
    const bool mirrored = is_mirrored(transforms_[piece.transform].linear);
    const std::size_t count = triangles_of(piece);
    for (std::size_t i = 0; i < count; ++i) {
      uvec3 t;
      if (mode == TINYGLTF_MODE_TRIANGLES) {
        t = {index(3 * i), index(3 * i + 1), index(3 * i + 2)};
      } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        t = {index(i), index(i + 1 + i % 2), index(i + 2 - i % 2)};
      } else {
        t = {index(i + 1), index(i + 2), index(0)};
      }
      if (t.x == t.y || t.y == t.z || t.z == t.x) {
        if (mode != TINYGLTF_MODE_TRIANGLE_STRIP) ++degenerate_;  // which join the parts of strips
        continue;
      }
      if (mirrored) std::swap(t.y, t.z);
      mesh_.triangles.push_back(t + piece.first_vertex);
    }
  }

  /// Corners that have no normal get that of their triangle.
  void finish_normals() {
    if (!has_normals_) return;
    const auto is_zero = [](const vec3& n) { return n == vec3(0.0f); };
    if (std::none_of(mesh_.normals.begin(), mesh_.normals.end(), is_zero)) return;
    mesh_.normal_indices = mesh_.triangles;
    const auto given = static_cast<std::uint32_t>(mesh_.normals.size());
    for (std::uint32_t i = 0; i < mesh_.normal_indices.size(); ++i) {
      uvec3& corners = mesh_.normal_indices[i];
      const auto own = static_cast<std::uint32_t>(mesh_.normals.size());
      for (int c = 0; c < 3; ++c) {
        if (corners[c] < given && is_zero(mesh_.normals[corners[c]])) corners[c] = own;
      }
      if (corners.x == own || corners.y == own || corners.z == own) {
        mesh_.normals.push_back(face_normal(triangle_corners(mesh_, i)));
      }
    }
  }

  MeshMaterials finish_materials() {
    MeshMaterials result;
    if (options_.ignore_materials || runs_.empty()) return result;
    result.common = runs_.front().material;
    if (runs_.size() == 1) return result;
    if (library_.materials.size() > std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1) {
      document_.fail("more than 65536 materials in the scene");
    }
    result.per_triangle.reserve(mesh_.triangles.size());
    for (const Run& run : runs_) result.per_triangle.resize(run.end, static_cast<std::uint16_t>(run.material));
    return result;
  }

  /// Triangles in a row that have one material.
  struct Run {
    std::size_t end;
    std::uint32_t material;
  };

  MaterialLibrary& library_;
  const ObjOptions& options_;
  GltfDocument document_;
  GltfMaterials materials_;
  std::vector<GltfAffine> transforms_;
  std::map<std::array<int, 4>, std::uint32_t> shared_;  // first vertex by accessors, of the node at hand
  std::vector<Piece> pieces_;
  std::uint64_t visits_ = 0, vertices_ = 0, triangles_ = 0;  // visits: of primitives, by nodes
  bool has_normals_ = false, has_texcoords_ = false;
  TriangleMesh mesh_;
  std::vector<Run> runs_;
  std::size_t bad_normals_ = 0, degenerate_ = 0;
};

}  // namespace

MeshWithMaterials read_gltf_into(MaterialLibrary& library, const std::filesystem::path& file,
                                 const ObjOptions& options) {
  return GltfBuilder(library, file, options).build();
}

}  // namespace raylab
