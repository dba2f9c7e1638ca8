#include "raylab/io/obj_file.hpp"

#include <tiny_obj_loader.h>

#include <array>
#include <cmath>
#include <istream>
#include <set>
#include <span>
#include <utility>

#include "corner_indices.hpp"
#include "file_bytes.hpp"
#include "message_text.hpp"
#include "obj_materials.hpp"
#include "obj_reader.hpp"
#include "obj_source.hpp"
#include "polygon.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

constexpr std::uint32_t kNone = CornerIndices::kNone;

/// Normal of a triangle by its winding; up when it has no area.
vec3 face_normal(const Triangle& t) {
  const dvec3 normal = glm::cross(dvec3(t.p1) - dvec3(t.p0), dvec3(t.p2) - dvec3(t.p0));
  const double length = glm::length(normal);
  return length > 0.0 ? vec3(normal / length) : vec3(0.0f, 1.0f, 0.0f);
}

/// How often something happened, and the line where it first did.
struct Tally {
  std::size_t count = 0;
  int first_line = 0;

  void add(int line) {
    if (count++ == 0) first_line = line;
  }
};

/// Builds a mesh from the statements of one OBJ file as they come.
class ObjBuilder {
 public:
  ObjBuilder(MaterialLibrary& library, const std::filesystem::path& file, const ObjOptions& options)
      : library_(library),
        file_(file),
        materials_(file, options),
        source_(read_file(file), file.string(),
                [this](std::string_view keyword, std::string_view rest) { other(keyword, rest); }) {
    library.files.push_back(file);
  }

  MeshWithMaterials build() {
    const ObjSource::Counts counts = source_.counts();
    mesh_.positions.reserve(counts.vertices + 2);  // with what pad_positions() asks for
    mesh_.normals.reserve(counts.normals);
    mesh_.texcoords.reserve(counts.texcoords);
    mesh_.triangles.reserve(counts.faces);

    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, float x, float y, float z, float) {
      static_cast<ObjBuilder*>(self)->vertex({x, y, z});
    };
    callbacks.normal_cb = [](void* self, float x, float y, float z) {
      static_cast<ObjBuilder*>(self)->normal({x, y, z});
    };
    callbacks.texcoord_cb = [](void* self, float u, float v, float) {
      static_cast<ObjBuilder*>(self)->texcoord({u, v});
    };
    callbacks.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
      static_cast<ObjBuilder*>(self)->face({corners, static_cast<std::size_t>(count)});
    };
    std::istream stream(&source_);
    stream.exceptions(std::ios::badbit);  // errors found while a line is fetched reach the caller
    tinyobj::LoadObjWithCallback(stream, callbacks, this);

    finish_normals();
    finish_texcoords();
    mesh_.pad_positions();
    warn_of_tallies();
    return {std::move(mesh_), materials_.finish(library_)};
  }

 private:
  struct Corner {
    std::uint32_t position, texcoord, normal;
  };

  void vertex(const vec3& p) {
    if (!is_finite(p)) source_.fail("finite coordinates");
    mesh_.positions.push_back(p);
  }

  /// Keeps a normal of length zero as it is: faces that use it take their own instead.
  void normal(const vec3& n) {
    if (!is_finite(n)) source_.fail("a finite normal");
    const double length = glm::length(dvec3(n));
    if (!(length > 0.0)) zero_normals_.add(source_.line());
    mesh_.normals.push_back(length > 0.0 ? vec3(dvec3(n) / length) : vec3(0.0f));
  }

  void texcoord(const vec2& uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) source_.fail("finite texture coordinates");
    mesh_.texcoords.push_back(uv);
  }

  /// From an index of the file, from 1 up or from -1 down; 0 when it was left out.
  std::uint32_t resolved(int index, std::size_t count, const char* what) const {
    if (index == 0) return kNone;
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t at = index > 0 ? std::int64_t{index} - 1 : size + index;
    if (at < 0 || at >= size) {
      const std::string last = std::to_string(count);
      source_.fail(std::to_string(index),
                   count == 0 ? "no " + std::string(what) + " index, as none is defined before this line"
                              : "a " + std::string(what) + " index from 1 to " + last + " or from -1 to -" + last);
    }
    return static_cast<std::uint32_t>(at);
  }

  Corner corner(const tinyobj::index_t& i) const {
    Corner c{};
    c.position = resolved(i.vertex_index, mesh_.positions.size(), "vertex");
    c.texcoord = resolved(i.texcoord_index, mesh_.texcoords.size(), "texture coordinate");
    c.normal = resolved(i.normal_index, mesh_.normals.size(), "normal");
    if (c.normal != kNone && mesh_.normals[c.normal] == vec3(0.0f)) c.normal = kNone;
    return c;
  }

  void face(std::span<const tinyobj::index_t> indices) {
    polygon_.clear();
    for (const tinyobj::index_t& i : indices) {
      const Corner c = corner(i);
      if (polygon_.empty() || polygon_.back().position != c.position) polygon_.push_back(c);
    }
    while (polygon_.size() > 1 && polygon_.front().position == polygon_.back().position) polygon_.pop_back();
    if (polygon_.size() < 3) {
      degenerate_.add(source_.line());
    } else if (polygon_.size() == 3) {
      triangle(polygon_[0], polygon_[1], polygon_[2]);
    } else {
      polygon();
    }
  }

  void polygon() {
    points_.clear();
    pieces_.clear();
    for (const Corner& c : polygon_) points_.push_back(mesh_.positions[c.position]);
    if (!triangulate(points_, pieces_)) tangled_.add(source_.line());
    for (const auto& piece : pieces_) triangle(polygon_[piece[0]], polygon_[piece[1]], polygon_[piece[2]]);
  }

  void triangle(const Corner& a, const Corner& b, const Corner& c) {
    mesh_.triangles.emplace_back(a.position, b.position, c.position);
    normal_indices_.add(uvec3(a.normal, b.normal, c.normal), mesh_.triangles);
    texcoord_indices_.add(uvec3(a.texcoord, b.texcoord, c.texcoord), mesh_.triangles);
    materials_.add_triangle(mesh_.triangles.size(), source_.line());
  }

  void other(std::string_view keyword, std::string_view rest) {
    if (!materials_.statement(keyword, rest, source_.location(), library_)) ignored(keyword);
  }

  /// Names and groups do not change the picture; what else is left out may.
  void ignored(std::string_view keyword) {
    for (const char* harmless : {"o", "g", "s", "f", "mg", "bevel", "c_interp", "d_interp", "lod"}) {
      if (keyword == harmless) return;
    }
    if (!warned_.emplace(keyword).second) return;
    library_.warnings.push_back(source_.location() + ": " + in_quotes(keyword) + " is not understood and left out");
  }

  void finish_normals() {
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

  void finish_texcoords() {
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

  void warn_of_tallies() {
    const auto warn = [&](const Tally& tally, const std::string& what) {
      if (tally.count == 0) return;
      library_.warnings.push_back(file_.string() + ":" + std::to_string(tally.first_line) + ": " + what + ": " +
                                  std::to_string(tally.count) + ", the first on this line");
    };
    warn(degenerate_, "faces of fewer than 3 distinct corners, left out");
    warn(tangled_, "polygons that cross themselves or have no area, split as fans");
    warn(zero_normals_, "normals of length zero, replaced by those of the faces");
    if (mesh_.triangles.empty()) library_.warnings.push_back(file_.string() + ": no faces");
  }

  MaterialLibrary& library_;
  std::filesystem::path file_;
  TriangleMesh mesh_;
  CornerIndices normal_indices_, texcoord_indices_;
  ObjMaterials materials_;
  ObjSource source_;
  Tally degenerate_, tangled_, zero_normals_;
  std::set<std::string> warned_;
  // Of the face at hand; kept to save allocations.
  std::vector<Corner> polygon_;
  std::vector<vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
};

}  // namespace

MeshWithMaterials read_obj_into(MaterialLibrary& library, const std::filesystem::path& file,
                                const ObjOptions& options) {
  return ObjBuilder(library, file, options).build();
}

ObjMesh read_obj(const std::filesystem::path& file, const ObjOptions& options) {
  MaterialLibrary library;
  MeshWithMaterials read = read_obj_into(library, file, options);
  ObjMesh result;
  result.mesh = std::move(read.mesh);
  result.mesh_materials = std::move(read.materials);
  result.materials = std::move(library.materials);
  result.warnings = std::move(library.warnings);
  result.notes = std::move(library.notes);
  result.files = std::move(library.files);
  result.files.insert(result.files.end(), library.textures.files().begin(), library.textures.files().end());
  result.textures = library.textures.take_images();
  return result;
}

}  // namespace raylab
