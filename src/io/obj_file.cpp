#include "raylab/io/obj_file.hpp"

#include <tiny_obj_loader.h>

#include <cmath>
#include <istream>
#include <set>
#include <span>
#include <utility>

#include "face_builder.hpp"
#include "file_bytes.hpp"
#include "message_text.hpp"
#include "obj_materials.hpp"
#include "obj_reader.hpp"
#include "obj_source.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

constexpr std::uint32_t kNone = FaceBuilder::kNone;

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

    faces_.finish(library_.warnings, file_.string(),
                  [&](std::size_t line) { return file_.string() + ":" + std::to_string(line); });
    warn_of_absent(absent_texcoords_, "texture coordinates");
    warn_of_absent(absent_normals_, "normals");
    return {std::move(mesh_), materials_.finish(library_)};
  }

 private:
  std::size_t line() const { return static_cast<std::size_t>(source_.line()); }

  void vertex(const vec3& p) {
    if (!is_finite(p)) source_.fail("finite coordinates");
    mesh_.positions.push_back(p);
  }

  void normal(const vec3& n) {
    if (!is_finite(n)) source_.fail("a finite normal");
    faces_.add_normal(n, line());
  }

  void texcoord(const vec2& uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) source_.fail("finite texture coordinates");
    mesh_.texcoords.push_back(uv);
  }

  /// From an index of the file, from 1 up or from -1 down; kNone when it is out of range.
  static std::uint32_t resolved(int index, std::size_t count) {
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t at = index > 0 ? std::int64_t{index} - 1 : size + index;
    return index == 0 || at < 0 || at >= size ? kNone : static_cast<std::uint32_t>(at);
  }

  std::uint32_t vertex_of(int index) const {
    const std::size_t count = mesh_.positions.size();
    const std::uint32_t at = resolved(index, count);
    if (at != kNone) return at;
    const std::string last = std::to_string(count);
    source_.fail(std::to_string(index), count == 0 ? "no vertex index, as none is defined before this line"
                                                   : "a vertex index from 1 to " + last + " or from -1 to -" + last);
  }

  /// A corner is drawn without an attribute that it names and the file lacks: files that renumber their texture
  /// coordinates badly are not rare.
  std::uint32_t attribute_of(int index, std::size_t count, Tally& absent) const {
    const std::uint32_t at = resolved(index, count);
    if (at == kNone && index != 0) absent.add(line());
    return at;
  }

  FaceBuilder::Corner corner(const tinyobj::index_t& i) {
    FaceBuilder::Corner c{};
    c.position = vertex_of(i.vertex_index);
    c.texcoord = attribute_of(i.texcoord_index, mesh_.texcoords.size(), absent_texcoords_);
    c.normal = attribute_of(i.normal_index, mesh_.normals.size(), absent_normals_);
    return c;
  }

  void warn_of_absent(const Tally& absent, const char* what) {
    if (absent.count == 0) return;
    library_.warnings.push_back(file_.string() + ":" + std::to_string(absent.first) + ": indices of " + what +
                                " that the file does not hold before their line, left out: " +
                                std::to_string(absent.count) + ", the first here");
  }

  void face(std::span<const tinyobj::index_t> indices) {
    corners_.clear();
    for (const tinyobj::index_t& i : indices) corners_.push_back(corner(i));
    std::size_t count = mesh_.triangles.size();
    faces_.add_face(corners_, line());
    while (count < mesh_.triangles.size()) materials_.add_triangle(++count, source_.line());
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

  MaterialLibrary& library_;
  std::filesystem::path file_;
  TriangleMesh mesh_;
  FaceBuilder faces_{mesh_};
  ObjMaterials materials_;
  ObjSource source_;
  std::set<std::string> warned_;
  Tally absent_texcoords_, absent_normals_;
  std::vector<FaceBuilder::Corner> corners_;  // of the face at hand; kept to save allocations
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
