#include "stl_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <utility>

#include "face_builder.hpp"
#include "file_bytes.hpp"
#include "geometry/point_table.hpp"
#include "message_text.hpp"
#include "raylab/core/error.hpp"
#include "word_reader.hpp"

namespace raylab {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;  // of a binary file; the header's last 4 are the count
constexpr std::uint32_t kNone = FaceBuilder::kNone;

std::uint32_t little_endian(const char* at) {
  std::array<unsigned char, 4> bytes;
  std::memcpy(bytes.data(), at, bytes.size());
  return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 | std::uint32_t{bytes[3]} << 24;
}

bool is_word(std::string_view found, std::string_view word) {
  return std::equal(found.begin(), found.end(), word.begin(), word.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

/// Whether a file is binary: its size is that of its count of facets, or it does not look like a text.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeaderBytes) {
    const std::uint64_t count = little_endian(bytes.data() + kHeaderBytes - 4);
    if (bytes.size() == kHeaderBytes + count * kFacetBytes) return true;
  }
  WordReader words(bytes, "");
  words.find_word();
  return bytes.substr(0, kHeaderBytes).find('\0') != bytes.npos || !is_word(words.word(), "solid");
}

/// Builds a mesh from one STL file.
class StlReader {
 public:
  StlReader(MaterialLibrary& library, const std::filesystem::path& file)
      : library_(library), file_(file), bytes_(read_file(file)), is_binary_(is_binary(bytes_)) {
    library.files.push_back(file);
  }

  MeshWithMaterials build(const ObjOptions& options) {
    if (is_binary_) {
      read_binary();
    } else {
      read_text();
    }
    faces_.finish(library_.warnings, file_.string(), [&](std::size_t place) { return location(place); });
    MeshMaterials materials;
    if (!mesh_.triangles.empty() && !options.ignore_materials) {
      materials.common = library_.default_material(file_.string());
    }
    return {std::move(mesh_), std::move(materials)};
  }

 private:
  /// A line of text, or a byte.
  std::string location(std::size_t place) const {
    return file_.string() + (is_binary_ ? ", byte " : ":") + std::to_string(place);
  }

  [[noreturn]] void fail_at(std::size_t place, const std::string& found, const std::string& expected) const {
    throw Error(ErrorKind::input, location(place), "found " + found + ", expected " + expected);
  }

  void add_facet(const std::array<vec3, 3>& points, PointTable& table, std::size_t place) {
    if (mesh_.positions.size() > kNone - 3) fail_at(place, "another facet", "at most 4294967295 vertices");
    std::array<FaceBuilder::Corner, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = {table.index_of(points[i]), kNone, kNone};
    const std::uint32_t a = corners[0].position, b = corners[1].position, c = corners[2].position;
    if (a != b && b != c && c != a) {
      faces_.add_triangle(corners[0], corners[1], corners[2]);
    } else {
      faces_.add_face(corners, place);  // which counts it among those left out
    }
  }

  void read_points(std::size_t facet, std::array<vec3, 3>& points) const {
    const std::size_t at = facet + 3 * sizeof(float);  // after the normal
    for (std::size_t i = 0; i < 9; ++i) {
      const float x = std::bit_cast<float>(little_endian(bytes_.data() + at + sizeof(float) * i));
      if (!std::isfinite(x)) fail_at(at + sizeof(float) * i, number_text(x), "a finite coordinate");
      points[i / 3][static_cast<int>(i % 3)] = x + 0.0f;  // 0 for -0, which is the same place
    }
  }

  void read_binary() {
    if (bytes_.size() < kHeaderBytes) {
      fail_at(0, std::to_string(bytes_.size()) + " bytes", "a header of 84 bytes, or a text that begins with solid");
    }
    const std::size_t count = little_endian(bytes_.data() + kHeaderBytes - 4);
    const std::size_t most = (bytes_.size() - kHeaderBytes) / kFacetBytes;
    if (count > most) {
      fail_at(kHeaderBytes - 4, std::to_string(count) + " facets",
              "at most the " + std::to_string(most) + " that the file has bytes for");
    }
    mesh_.triangles.reserve(count);
    mesh_.positions.reserve(count / 2 + 4);  // of a closed mesh of triangles
    PointTable table(mesh_.positions, count / 2 + 4);
    // A facet's points are fetched while the 32 before it are looked up.
    std::array<std::array<vec3, 3>, 32> ahead;
    for (std::size_t i = 0; i < count + ahead.size(); ++i) {
      std::array<vec3, 3>& points = ahead[i % ahead.size()];
      if (i >= ahead.size()) add_facet(points, table, kHeaderBytes + (i - ahead.size()) * kFacetBytes);
      if (i >= count) continue;
      read_points(kHeaderBytes + i * kFacetBytes, points);
      for (const vec3& p : points) table.prefetch(p);
    }
    const std::size_t end = kHeaderBytes + count * kFacetBytes;
    if (end < bytes_.size()) library_.warnings.push_back(location(end) + ": what follows the last facet is left out");
  }

  void read_text() {
    WordReader words(bytes_, file_.string());
    PointTable table(mesh_.positions, 0);
    const auto next = [&] {
      words.find_word();
      return words.word();
    };
    const auto expect = [&](const char* expected) {
      if (const std::string_view word = next(); !is_word(word, expected)) words.fail(word, expected);
    };
    while (words.find_word()) {
      expect("solid");
      words.rest_of_line();  // its name
      for (std::string_view word = next(); !is_word(word, "endsolid"); word = next()) {
        if (!is_word(word, "facet")) words.fail(word, "facet or endsolid");
        const std::size_t line = words.line();
        expect("normal");
        // Normals are not used, and not a number in some files.
        for (int c = 0; c < 3; ++c) next();
        expect("outer");
        expect("loop");
        std::array<vec3, 3> points;
        for (vec3& point : points) {
          expect("vertex");
          for (int c = 0; c < 3; ++c) {
            const std::string_view number = next();
            point[c] = static_cast<float>(number_of_word(number).value_or(NAN)) + 0.0f;  // 0 for -0
            if (!std::isfinite(point[c])) words.fail(number, "a finite coordinate");
          }
        }
        expect("endloop");
        expect("endfacet");
        add_facet(points, table, line);
      }
      words.rest_of_line();
    }
  }

  MaterialLibrary& library_;
  std::filesystem::path file_;
  std::string bytes_;
  bool is_binary_;
  TriangleMesh mesh_;
  FaceBuilder faces_{mesh_};
};

}  // namespace

MeshWithMaterials read_stl_into(MaterialLibrary& library, const std::filesystem::path& file,
                                const ObjOptions& options) {
  return StlReader(library, file).build(options);
}

}  // namespace raylab
