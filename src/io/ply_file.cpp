#include "ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "face_builder.hpp"
#include "file_bytes.hpp"
#include "message_text.hpp"
#include "ply_header.hpp"
#include "raylab/core/error.hpp"

namespace raylab {
namespace {

using Corner = FaceBuilder::Corner;
constexpr std::uint32_t kNone = FaceBuilder::kNone;

/// What is read of a vertex: x y z, nx ny nz and the texture coordinates, in this order.
constexpr std::size_t kRoles = 8;

/// The number at `at`, with its bytes in the other order if `swapped`.
template <class T>
T loaded(const char* at, bool swapped) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swapped) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

bool is_whole(double value, double below) { return value >= 0.0 && value < below && value == std::floor(value); }

/// Builds a mesh from one PLY file. The fast paths are short cuts: what is not plain goes the way of everything else,
/// which tells what is wrong.
class PlyReader {
 public:
  PlyReader(MaterialLibrary& library, const std::filesystem::path& file)
      : library_(library),
        file_(file),
        text_(read_file(file)),
        words_(text_, file.string()),
        header_(read_ply_header(text_, words_, library.warnings)),
        ascii_(header_.format == PlyHeader::Format::ascii),
        swapped_((header_.format == PlyHeader::Format::big_endian) != (std::endian::native == std::endian::big)),
        at_(header_.end) {
    library.files.push_back(file);
  }

  MeshWithMaterials build(const ObjOptions& options) {
    read_elements();
    if (mesh_.triangles.size() > kNone) throw Error(ErrorKind::input, file_.string(), "more than 4294967295 triangles");
    faces_.finish();
    for (std::string& warning : faces_.warnings([&](std::size_t place) { return location(place); })) {
      library_.warnings.push_back(std::move(warning));
    }
    MeshMaterials materials;
    if (mesh_.triangles.empty()) {
      library_.warnings.push_back(file_.string() + ": no faces");
    } else if (!options.ignore_materials) {
      materials.common = material();
    }
    return {std::move(mesh_), std::move(materials)};
  }

 private:
  /// A line of text, or a byte.
  std::string location(std::size_t place) const {
    return file_.string() + (ascii_ ? ":" : ", byte ") + std::to_string(place);
  }

  /// Throws for the number read last.
  [[noreturn]] void fail(double number, const std::string& expected) const {
    if (ascii_) words_.fail(word_, expected);
    fail_at(number_at_, number_text(number), expected);
  }
  [[noreturn]] void fail_at(std::size_t place, const std::string& found, const std::string& expected) const {
    throw Error(ErrorKind::input, location(place), "found " + found + ", expected " + expected);
  }

  std::size_t bytes_left() const { return ascii_ ? words_.bytes_left() : text_.size() - at_; }

  double number(PlyType type, const PlyProperty& property) {
    if (ascii_) {
      word_ = words_.word();
      const auto number = number_of_word(word_);
      if (!number) words_.fail(word_, "a number for " + in_quotes(property.name));
      return *number;
    }
    if (bytes_left() < size_of(type)) fail_at(at_, "the end of the file", "a number for " + in_quotes(property.name));
    number_at_ = at_;
    at_ += size_of(type);
    const char* from = text_.data() + number_at_;
    switch (type) {
      case PlyType::int8:
        return loaded<std::int8_t>(from, swapped_);
      case PlyType::uint8:
        return loaded<std::uint8_t>(from, swapped_);
      case PlyType::int16:
        return loaded<std::int16_t>(from, swapped_);
      case PlyType::uint16:
        return loaded<std::uint16_t>(from, swapped_);
      case PlyType::int32:
        return loaded<std::int32_t>(from, swapped_);
      case PlyType::uint32:
        return loaded<std::uint32_t>(from, swapped_);
      case PlyType::float32:
        return double{loaded<float>(from, swapped_)};
      case PlyType::float64:
        return loaded<double>(from, swapped_);
    }
    return 0.0;
  }

  float finite_number(const PlyProperty& property) {
    const double given = number(property.type, property);
    const float rounded = static_cast<float>(given);
    if (!std::isfinite(rounded)) fail(given, "a finite number for " + in_quotes(property.name));
    return rounded;
  }

  /// How many values of a list follow: the file has bytes for them.
  std::size_t list_count(const PlyProperty& property) {
    const double count = number(*property.count, property);
    const std::size_t most = bytes_left() / (ascii_ ? 2 : size_of(property.type));
    if (!is_whole(count, static_cast<double>(most) + 1.0)) {
      fail(count, "how many values of " + in_quotes(property.name) + " follow, up to the " + std::to_string(most) +
                      " that the file has bytes for");
    }
    return static_cast<std::size_t>(count);
  }

  void skip(const PlyProperty& property) {
    const std::size_t count = property.count ? list_count(property) : 1;
    if (property.count && !ascii_) {
      at_ += count * size_of(property.type);
    } else {
      for (std::size_t i = 0; i < count; ++i) number(property.type, property);
    }
  }

  /// No memory is taken, and no loop begun, for more than the file can hold.
  void check_size(const PlyElement& element) const {
    const std::size_t least = ascii_ ? 2 * element.properties.size() : element.smallest();
    const std::size_t left = bytes_left() + (ascii_ ? 1 : 0);  // the last line may lack its end
    if (least == 0 || element.count <= left / least) return;
    fail_at(ascii_ ? static_cast<std::size_t>(words_.line()) : at_, std::to_string(bytes_left()) + " bytes",
            std::to_string(element.count) + " of element " + in_quotes(element.name) + ", each of " +
                std::to_string(least) + " bytes or more");
  }

  /// Begins one of an element, which has a line of its own in a text. Returns the place.
  std::size_t begin(const PlyElement& element) {
    if (!ascii_) return at_;
    if (!words_.find_word()) words_.fail("", "another " + in_quotes(element.name));
    return static_cast<std::size_t>(words_.line());
  }

  void end() {
    if (!ascii_) return;
    if (const std::string_view word = words_.word(); !word.empty()) words_.fail(word, "the end of the line");
  }

  void skip(const PlyElement& element) {
    check_size(element);
    if (element.properties.empty()) return;
    if (!ascii_ && !element.has_lists()) {
      at_ += element.count * element.smallest();
      return;
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      begin(element);
      for (const PlyProperty& property : element.properties) skip(property);
      end();
    }
  }

  void read_elements() {
    struct Later {
      const PlyElement* element;
      WordReader words;
      std::size_t at;
    };
    std::vector<Later> before_vertices;
    bool has_vertices = true;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") has_vertices = false;  // not yet
      if (is_faces(element) && element.find({"texcoord"})) corner_texcoords_ = true;
    }
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
        has_vertices = true;
      } else if (is_faces(element) && has_vertices) {
        read_faces(element);
      } else {
        if (is_faces(element)) before_vertices.push_back({&element, words_, at_});
        skip(element);
      }
    }
    warn_of_rest();
    for (const Later& later : before_vertices) {
      words_ = later.words;
      at_ = later.at;
      read_faces(*later.element);
    }
  }

  static bool is_faces(const PlyElement& element) { return element.name == "face" || element.name == "tristrips"; }

  void warn_of_rest() {
    if (ascii_ ? !words_.find_word() : bytes_left() == 0) return;
    library_.warnings.push_back(location(ascii_ ? static_cast<std::size_t>(words_.line()) : at_) +
                                ": what follows the last element is left out");
  }

  void warn_of_colors(const PlyElement& element) {
    const auto color = element.find({"red", "diffuse_red", "r"});
    if (!color) return;
    library_.warnings.push_back(element.properties[*color].location + ": " + element.name + " colours are left out");
  }

  /// The role of each property of a vertex; kRoles: none.
  std::vector<std::size_t> vertex_roles(const PlyElement& element) const {
    std::vector<std::size_t> roles(element.properties.size(), kRoles);
    const auto take = [&](std::size_t first_role, std::initializer_list<const char*> names) {
      for (const char* name : names) {
        if (!element.find({name})) return false;
      }
      for (const char* name : names) {
        const std::size_t at = *element.find({name});
        if (element.properties[at].count) {
          throw Error(ErrorKind::input, element.properties[at].location,
                      "found a list, expected a number for " + in_quotes(name));
        }
        roles[at] = first_role++;
      }
      return true;
    };
    if (!take(0, {"x", "y", "z"})) {
      throw Error(ErrorKind::input, element.location, "found no x, y and z, expected them among the properties");
    }
    take(3, {"nx", "ny", "nz"});
    if (!corner_texcoords_ && !take(6, {"s", "t"}) && !take(6, {"u", "v"}) && !take(6, {"texture_u", "texture_v"})) {
      take(6, {"texture_s", "texture_t"});
    }
    return roles;
  }

  void read_vertices(const PlyElement& element) {
    if (element.count == 0) return;
    check_size(element);
    if (element.count >= kNone) {
      throw Error(ErrorKind::input, element.location,
                  "found " + std::to_string(element.count) + " vertices, expected at most 4294967294");
    }
    warn_of_colors(element);
    const std::vector<std::size_t> roles = vertex_roles(element);
    std::array<std::size_t, kRoles> offsets{};
    bool plain = !ascii_ && !element.has_lists(), normals = false, texcoords = false;
    std::size_t size = 0;
    for (std::size_t i = 0; i < roles.size(); ++i) {
      if (roles[i] < kRoles) {
        offsets[roles[i]] = size;
        plain = plain && element.properties[i].type == PlyType::float32;
        normals = normals || roles[i] == 3;
        texcoords = texcoords || roles[i] == 6;
      }
      size += size_of(element.properties[i].type);
    }
    const auto count = static_cast<std::size_t>(element.count);
    mesh_.positions.reserve(count + 2);  // with what pad_positions() asks for
    if (normals) mesh_.normals.reserve(count);
    if (texcoords) mesh_.texcoords.reserve(count);

    std::array<float, kRoles> v{};
    const auto load_plain = [&] {
      const char* from = text_.data() + at_;
      const auto load = [&](std::size_t role) { v[role] = loaded<float>(from + offsets[role], swapped_); };
      load(0), load(1), load(2);
      if (normals) load(3), load(4), load(5);
      if (texcoords) load(6), load(7);
      float zero = 0.0f;  // NaN if something is not finite
      for (const float x : v) zero += x - x;
      return zero == 0.0f;
    };
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = begin(element);
      if (plain && load_plain()) {
        at_ += size;
      } else {
        for (std::size_t p = 0; p < roles.size(); ++p) {
          const PlyProperty& property = element.properties[p];
          if (roles[p] < kRoles) {
            v[roles[p]] = finite_number(property);
          } else {
            skip(property);
          }
        }
        end();
      }
      mesh_.positions.emplace_back(v[0], v[1], v[2]);
      if (normals) faces_.add_normal({v[3], v[4], v[5]}, place);
      if (texcoords) mesh_.texcoords.emplace_back(v[6], v[7]);
    }
  }

  Corner corner(std::uint32_t i) const {
    return {i, mesh_.texcoords.empty() || corner_texcoords_ ? kNone : i, mesh_.normals.empty() ? kNone : i};
  }

  void read_faces(const PlyElement& element) {
    const auto indices = element.find({"vertex_indices", "vertex_index"});
    if (!indices) return skip(element);
    const auto texcoords = element.find({"texcoord"});
    for (const auto& list : {indices, texcoords}) {
      if (!list || element.properties[*list].count) continue;
      throw Error(ErrorKind::input, element.properties[*list].location,
                  "found a number, expected a list for " + in_quotes(element.properties[*list].name));
    }
    check_size(element);
    warn_of_colors(element);
    const PlyProperty& index = element.properties[*indices];
    const std::size_t least = ascii_ ? 8 : element.smallest() + 3 * size_of(index.type);  // of one triangle
    mesh_.triangles.reserve(std::min<std::uint64_t>(element.count, bytes_left() / least));

    const bool strips = element.name == "tristrips";
    std::size_t before = 0;
    bool plain = !ascii_ && !strips && !faces_.has_zero_normals() && size_of(*index.count) == 1 &&
                 (index.type == PlyType::int32 || index.type == PlyType::uint32);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (i < *indices) before += element.properties[i].smallest();
      plain = plain && (i == *indices || !element.properties[i].count);
    }
    const std::size_t size = element.smallest() + 3 * sizeof(std::uint32_t);
    const std::size_t end_of_indices =
        std::min<std::size_t>(mesh_.positions.size(), index.type == PlyType::int32 ? std::size_t{1} << 31 : kNone);
    const auto add_plain = [&] {
      const char* from = text_.data() + at_ + before;
      if (bytes_left() < size || *from != 3) return false;
      const auto a = loaded<std::uint32_t>(from + 1, swapped_), b = loaded<std::uint32_t>(from + 5, swapped_),
                 c = loaded<std::uint32_t>(from + 9, swapped_);
      if (std::max({a, b, c}) >= end_of_indices || a == b || b == c || c == a) return false;
      faces_.add_triangle(corner(a), corner(b), corner(c));
      at_ += size;
      return true;
    };
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (plain && add_plain()) continue;
      const std::size_t place = begin(element);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == *indices) {
          read_indices(property, strips);
        } else if (p == texcoords) {
          read_corner_texcoords(property);
        } else {
          skip(property);
        }
      }
      end();
      if (texcoords) add_corner_texcoords(place);
      if (strips) {
        add_strips(place);
      } else {
        faces_.add_face(corners_, place);
      }
    }
  }

  void read_indices(const PlyProperty& property, bool strips) {
    corners_.clear();
    const std::size_t vertices = mesh_.positions.size();
    for (std::size_t left = list_count(property); left > 0; --left) {
      const double index = number(property.type, property);
      if (is_whole(index, static_cast<double>(vertices))) {
        corners_.push_back(corner(static_cast<std::uint32_t>(index)));
      } else if (strips && index == -1.0) {
        corners_.push_back({kNone, kNone, kNone});  // the end of a strip
      } else {
        fail(index, vertices == 0 ? "no vertex index, as there are no vertices"
                                  : "a vertex index from 0 to " + std::to_string(vertices - 1));
      }
    }
  }

  void read_corner_texcoords(const PlyProperty& property) {
    texcoords_.clear();
    for (std::size_t left = list_count(property); left > 0; --left) texcoords_.push_back(finite_number(property));
  }

  void add_corner_texcoords(std::size_t place) {
    if (texcoords_.empty()) return;
    if (texcoords_.size() != 2 * corners_.size()) {
      fail_at(place, std::to_string(texcoords_.size()) + " texture coordinates",
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
        const auto [a, b, c] = triangle;
        if (a.position == b.position || b.position == c.position || c.position == a.position) continue;
        if ((i - start) % 2 == 1) std::swap(triangle[0], triangle[1]);
        faces_.add_face(triangle, place);
      }
    }
  }

  std::uint32_t material() {
    const std::string& name = header_.texture;
    const std::filesystem::path picture = file_.parent_path() / name;
    const auto default_material = [&](const char* why) {
      library_.warnings.push_back(header_.texture_location + ": texture " + in_quotes(name) + why);
      return library_.default_material(file_.string());
    };
    if (name.empty()) return library_.default_material(file_.string());
    if (mesh_.texcoords.empty()) return default_material(" is left out, as there are no texture coordinates");
    if (!is_file(picture)) return default_material(" is missing: grey (0.5) in its place");
    Material material;
    material.name = name;
    material.color.kind = Texture::Kind::image;
    material.color.image = library_.textures.load(picture, name);
    check_albedo(library_.textures.images()[material.color.image], header_.texture_location);
    return library_.add(std::move(material), header_.texture_location);
  }

  MaterialLibrary& library_;
  std::filesystem::path file_;
  std::string text_;
  WordReader words_;  // of the header, and of the elements of a text
  PlyHeader header_;
  bool ascii_;
  bool swapped_;
  std::size_t at_;                 // in a binary file
  std::size_t number_at_ = 0;      // where the number read last began, in a binary file
  std::string_view word_;          // the number read last, in a text
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
