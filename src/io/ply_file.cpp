#include "ply_file.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "face_builder.hpp"
#include "file_bytes.hpp"
#include "message_text.hpp"
#include "ply_header.hpp"
#include "ply_values.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

using Corner = FaceBuilder::Corner;
constexpr std::uint32_t kNone = FaceBuilder::kNone;

bool is_faces(const PlyElement& element) { return element.name == "face" || element.name == "tristrips"; }

/// Where the numbers of a vertex are: x y z, nx ny nz and the texture coordinates, in this order.
struct VertexLayout {
  static constexpr std::size_t kRoles = 8;
  std::vector<std::size_t> roles;             ///< by property; kRoles: none
  std::array<std::size_t, kRoles> offsets{};  ///< bytes, by role
  std::size_t size = 0;                       ///< bytes
  bool normals = false, texcoords = false;
  bool plain = true;  ///< a binary file's, and floats all that are taken
};

/// Builds a mesh from one PLY file. The ways for plain vertices and faces are short cuts: what is not plain goes the
/// way of everything else, which tells what is wrong.
class PlyReader {
 public:
  PlyReader(MaterialLibrary& library, const std::filesystem::path& file)
      : library_(library),
        file_(file),
        bytes_(read_file(file)),
        words_(bytes_, file.string()),
        header_(read_ply_header(bytes_, words_, library.warnings)),
        values_(bytes_, words_, header_, file.string()) {
    library.files.push_back(file);
  }

  MeshWithMaterials build(const ObjOptions& options) {
    read_elements();
    if (mesh_.triangles.size() > kNone) throw Error(ErrorKind::input, file_.string(), "more than 4294967295 triangles");
    faces_.finish(library_.warnings, file_.string(), [&](std::size_t place) { return values_.location(place); });
    MeshMaterials materials;
    if (!mesh_.triangles.empty() && !options.ignore_materials) materials.common = material();
    return {std::move(mesh_), std::move(materials)};
  }

 private:
  std::string header_location(std::size_t line) const { return file_.string() + ":" + std::to_string(line); }

  [[noreturn]] void fail_in_header(std::size_t line, const std::string& found, const std::string& expected) const {
    throw Error(ErrorKind::input, header_location(line), "found " + found + ", expected " + expected);
  }

  void read_elements() {
    bool has_vertices = true;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") has_vertices = false;  // not yet
      corner_texcoords_ = corner_texcoords_ || (is_faces(element) && element.find("texcoord"));
    }
    std::vector<std::pair<const PlyElement*, PlyValues>> before_vertices;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
        has_vertices = true;
      } else if (is_faces(element) && has_vertices) {
        read_faces(element);
      } else {
        if (is_faces(element)) before_vertices.emplace_back(&element, values_);
        values_.skip(element);
      }
    }
    if (values_.find_more()) {
      library_.warnings.push_back(values_.location(values_.place()) + ": what follows the last element is left out");
    }
    for (const auto& [element, values] : before_vertices) {
      values_ = values;
      read_faces(*element);
    }
  }

  void warn_of_colors(const PlyElement& element) {
    for (const char* name : {"red", "diffuse_red", "r"}) {
      if (const auto color = element.find(name)) {
        const std::string location = header_location(element.properties[*color].line);
        return library_.warnings.push_back(location + ": " + element.name + " colours are left out");
      }
    }
  }

  VertexLayout layout_of(const PlyElement& element) const {
    VertexLayout layout;
    layout.roles.assign(element.properties.size(), VertexLayout::kRoles);
    const auto take = [&](std::size_t first_role, std::initializer_list<const char*> names) {
      const auto is_there = [&](const char* name) { return element.find(name).has_value(); };
      if (!std::all_of(names.begin(), names.end(), is_there)) return false;
      for (const char* name : names) {
        const std::size_t at = *element.find(name);
        const PlyProperty& property = element.properties[at];
        if (property.count) fail_in_header(property.line, "a list", "a number for " + in_quotes(name));
        layout.roles[at] = first_role++;
      }
      return true;
    };
    if (!take(0, {"x", "y", "z"})) {
      fail_in_header(element.line, "an element \"vertex\" without x, y and z", "them among its properties");
    }
    layout.normals = take(3, {"nx", "ny", "nz"});
    layout.texcoords =
        !corner_texcoords_ && (take(6, {"s", "t"}) || take(6, {"u", "v"}) || take(6, {"texture_u", "texture_v"}) ||
                               take(6, {"texture_s", "texture_t"}));
    layout.plain = !values_.is_text() && !element.has_lists();
    for (std::size_t i = 0; i < layout.roles.size(); ++i) {
      if (layout.roles[i] < VertexLayout::kRoles) {
        layout.offsets[layout.roles[i]] = layout.size;
        layout.plain = layout.plain && element.properties[i].type == PlyType::float32;
      }
      layout.size += size_of(element.properties[i].type);
    }
    return layout;
  }

  void read_vertices(const PlyElement& element) {
    if (element.count == 0) return;
    values_.check_size(element);
    if (element.count >= kNone) {
      fail_in_header(element.line, std::to_string(element.count) + " vertices", "at most 4294967294");
    }
    warn_of_colors(element);
    const VertexLayout layout = layout_of(element);
    const auto count = static_cast<std::size_t>(element.count);
    mesh_.positions.reserve(count + 2);  // with what pad_positions() asks for
    if (layout.normals) mesh_.normals.reserve(count);
    if (layout.texcoords) mesh_.texcoords.reserve(count);

    std::array<float, VertexLayout::kRoles> v{};  // by role
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = values_.begin(element);
      if (!layout.plain || !take_plain_vertex(layout, v)) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
          if (layout.roles[p] < VertexLayout::kRoles) {
            v[layout.roles[p]] = values_.finite_number(element.properties[p]);
          } else {
            values_.skip(element.properties[p]);
          }
        }
        values_.end();
      }
      mesh_.positions.emplace_back(v[0], v[1], v[2]);
      if (layout.normals) faces_.add_normal({v[3], v[4], v[5]}, place);
      if (layout.texcoords) mesh_.texcoords.emplace_back(v[6], v[7]);
    }
  }

  /// False, with nothing taken, when a number is not finite.
  bool take_plain_vertex(const VertexLayout& layout, std::array<float, VertexLayout::kRoles>& v) {
    const auto take = [&](std::size_t first, std::size_t end) {
      for (std::size_t role = first; role < end; ++role) v[role] = values_.peek<float>(layout.offsets[role]);
    };
    take(0, 3);
    if (layout.normals) take(3, 6);
    if (layout.texcoords) take(6, 8);
    float zero = 0.0f;  // NaN if a number is not finite
    for (const float x : v) zero += x - x;
    if (zero != 0.0f) return false;
    values_.advance(layout.size);
    return true;
  }

  Corner corner(std::uint32_t i) const {
    return {i, mesh_.texcoords.empty() || corner_texcoords_ ? kNone : i, mesh_.normals.empty() ? kNone : i};
  }

  void read_faces(const PlyElement& element) {
    const auto indices = element.find("vertex_indices") ? element.find("vertex_indices") : element.find("vertex_index");
    if (!indices) return values_.skip(element);
    const auto texcoords = element.find("texcoord");
    for (const auto& list : {indices, texcoords}) {
      if (!list || element.properties[*list].count) continue;
      const PlyProperty& property = element.properties[*list];
      fail_in_header(property.line, "a number", "a list for " + in_quotes(property.name));
    }
    values_.check_size(element);
    warn_of_colors(element);
    const PlyProperty& index = element.properties[*indices];
    const std::size_t smallest = values_.is_text() ? 8 : element.smallest() + 3 * size_of(index.type);  // triangle
    mesh_.triangles.reserve(std::min<std::uint64_t>(element.count, values_.bytes_left() / smallest));

    const bool strips = element.name == "tristrips";
    const std::size_t plain_offset = strips ? kNotPlain : offset_in_plain(element, *indices);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (plain_offset != kNotPlain && take_plain_face(plain_offset, smallest, index.type)) continue;
      const std::size_t place = values_.begin(element);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == *indices) {
          read_indices(index, strips);
        } else if (p == texcoords) {
          read_corner_texcoords(element.properties[p]);
        } else {
          values_.skip(element.properties[p]);
        }
      }
      values_.end();
      if (texcoords) add_corner_texcoords(place);
      if (strips) {
        add_strips(place);
      } else {
        faces_.add_face(corners_, place);
      }
    }
  }

  /// Bytes before the list of indices in a face whose only list it is, with a count of one byte and indices of four,
  /// of a mesh whose triangles FaceBuilder needs not look at; kNotPlain of others.
  std::size_t offset_in_plain(const PlyElement& element, std::size_t indices) const {
    if (values_.is_text() || faces_.has_zero_normals()) return kNotPlain;
    std::size_t before = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i < indices) before += property.smallest();
      if (i != indices && property.count) return kNotPlain;
    }
    const PlyProperty& index = element.properties[indices];
    const bool four_bytes = index.type == PlyType::int32 || index.type == PlyType::uint32;
    return four_bytes && size_of(*index.count) == 1 ? before : kNotPlain;
  }

  /// False, with nothing taken, for anything but a good triangle.
  bool take_plain_face(std::size_t offset, std::size_t size, PlyType type) {
    if (values_.bytes_left() < size || values_.peek<std::uint8_t>(offset) != 3) return false;
    const auto a = values_.peek<std::uint32_t>(offset + 1), b = values_.peek<std::uint32_t>(offset + 5),
               c = values_.peek<std::uint32_t>(offset + 9);
    const std::uint32_t largest = std::max({a, b, c});
    if (largest >= mesh_.positions.size() || a == b || b == c || c == a) return false;
    if (type == PlyType::int32 && largest > 0x7fffffff) return false;  // less than 0
    faces_.add_triangle(corner(a), corner(b), corner(c));
    values_.advance(size);
    return true;
  }

  void read_indices(const PlyProperty& property, bool strips) {
    corners_.clear();
    const std::size_t vertices = mesh_.positions.size();
    for (std::size_t left = values_.list_count(property); left > 0; --left) {
      const double index = values_.number(property.type, property);
      if (is_whole(index, static_cast<double>(vertices))) {
        corners_.push_back(corner(static_cast<std::uint32_t>(index)));
      } else if (strips && index == -1.0) {
        corners_.push_back({kNone, kNone, kNone});  // the end of a strip
      } else {
        values_.fail(index, vertices == 0 ? "no vertex index, as there are no vertices"
                                          : "a vertex index from 0 to " + std::to_string(vertices - 1));
      }
    }
  }

  void read_corner_texcoords(const PlyProperty& property) {
    texcoords_.clear();
    for (std::size_t left = values_.list_count(property); left > 0; --left) {
      texcoords_.push_back(values_.finite_number(property));
    }
  }

  void add_corner_texcoords(std::size_t place) {
    if (texcoords_.empty()) return;
    if (texcoords_.size() != 2 * corners_.size()) {
      values_.fail_at(place, std::to_string(texcoords_.size()) + " texture coordinates",
                      std::to_string(2 * corners_.size()) + ", two for each corner");
    }
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      corners_[i].texcoord = static_cast<std::uint32_t>(mesh_.texcoords.size());
      mesh_.texcoords.emplace_back(texcoords_[2 * i], texcoords_[2 * i + 1]);
    }
  }

  /// Every second triangle of a strip turns the other way. Triangles without area lead from one strip to the next.
  void add_strips(std::size_t place) {
    std::size_t start = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i].position == kNone) {
        start = i + 1;
      } else if (i >= start + 2) {
        std::array<Corner, 3> triangle = {corners_[i - 2], corners_[i - 1], corners_[i]};
        const auto& [a, b, c] = triangle;
        if (a.position == b.position || b.position == c.position || c.position == a.position) continue;
        if ((i - start) % 2 == 1) std::swap(triangle[0], triangle[1]);
        faces_.add_face(triangle, place);
      }
    }
  }

  std::uint32_t material() {
    const std::string& name = header_.texture;
    if (name.empty()) return library_.default_material(file_.string());
    const std::string location = header_location(header_.texture_line);
    const std::filesystem::path picture = file_.parent_path() / name;
    const auto default_material = [&](const char* why) {
      library_.warnings.push_back(location + ": texture " + in_quotes(name) + why);
      return library_.default_material(file_.string());
    };
    if (mesh_.texcoords.empty()) return default_material(" is left out, as there are no texture coordinates");
    if (!is_file(picture)) return default_material(" is missing: grey (0.5) in its place");
    Material material;
    material.name = name;
    material.color.kind = Texture::Kind::image;
    material.color.image = library_.textures.load(picture, name);
    check_albedo(library_.textures.images()[material.color.image], location);
    return library_.add(std::move(material), location);
  }

  static constexpr std::size_t kNotPlain = ~std::size_t{0};

  MaterialLibrary& library_;
  std::filesystem::path file_;
  std::string bytes_;
  WordReader words_;  // of the header
  PlyHeader header_;
  PlyValues values_;
  bool corner_texcoords_ = false;  // faces have them, and those of vertices are left out
  TriangleMesh mesh_;
  FaceBuilder faces_{mesh_};
  // Of the face at hand; kept to save allocations.
  std::vector<Corner> corners_;
  std::vector<float> texcoords_;
};

}  // namespace

MeshWithMaterials read_ply_into(MaterialLibrary& library, const std::filesystem::path& file,
                                const ObjOptions& options) {
  return PlyReader(library, file).build(options);
}

}  // namespace raylab
