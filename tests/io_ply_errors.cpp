// Every bad PLY file is refused with its place and the value found.
#include "expect_error.hpp"
#include "ply_files.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

struct BadPly {
  std::string bytes;
  std::string place;  ///< ":LINE" or ", byte N"
  std::vector<const char*> parts;
};

void expect_all(const std::vector<BadPly>& files) {
  const InputFolder folder;
  for (const BadPly& bad : files) {
    INFO(bad.bytes);
    for (const char* part : bad.parts) {
      expect_error(ErrorKind::input, folder.at("mesh.ply" + bad.place), {part}, [&] { read_ply(folder, bad.bytes); });
    }
  }
}

}  // namespace

TEST_CASE("bad PLY headers are refused with their line", "[unit]") {
  const auto lines = [](const std::string& text) { return header("ascii", text); };
  expect_all({{"", ":1", {"found the end of the file, expected ply"}},
              {"\nply\n", ":1", {"expected ply"}},
              {"plys\n", ":1", {"found \"plys\""}},
              {"ply x\n", ":1", {"found \"x\", expected the end of the line"}},
              {"ply\n", ":2", {"found the end of the file, expected end_header"}},
              {"ply\nend_header\n", ":2", {"expected a format"}},
              {"ply\nformat binary 1.0\n", ":2", {"found \"binary\"", "binary_little_endian"}},
              {"ply\nformat ascii 2.0\n", ":2", {"found \"2.0\""}},
              {"ply\nformat\n", ":2", {"found the end of the line"}},
              {lines("element\n"), ":3", {"the name of an element"}},
              {lines("element vertex\n"), ":3", {"found the end of the line", "\"vertex\""}},
              {lines("element vertex -1\n"), ":3", {"found \"-1\""}},
              {lines("element vertex 1.5\n"), ":3", {"found \"1.5\""}},
              {lines("element vertex 99999999999999999999\n"), ":3", {"found \"99999999999999999999\""}},
              {lines("element vertex 1 1\n"), ":3", {"found \"1\", expected the end of the line"}},
              {lines("element a 0\nelement a 0\n"), ":4", {"found \"a\""}},
              {lines("property int a\n"), ":3", {"an element before it"}},
              {lines("element a 0\nproperty long a\n"), ":4", {"found \"long\", expected a type"}},
              {lines("element a 0\nproperty list uchar long a\n"), ":4", {"found \"long\", expected a type"}},
              {lines("element a 0\nproperty list uchar\n"), ":4", {"found the end of the line, expected a type"}},
              {lines("element a 0\nproperty int\n"), ":4", {"the name of a property"}},
              {lines("element a 0\nproperty int a\nproperty int a\n"), ":5", {"found \"a\""}},
              {lines("comment TextureFile\n"), ":3", {"the name of a picture"}}});
}

TEST_CASE("PLY elements that are not what they should be are refused with their line", "[unit]") {
  const auto lines = [](const std::string& text) { return header("ascii", text) + std::string(100, '\n'); };
  expect_all(
      {{lines("element vertex 3\nproperty float x\nproperty float y\n"), ":3", {"x, y and z"}},
       {lines("element vertex 3\n"), ":3", {"x, y and z"}},
       {lines("element vertex 3\nproperty float x\nproperty list uchar float y\nproperty float z\n"),
        ":5",
        {"found a list, expected a number for \"y\""}},
       {lines(kThree + "property float nx\nproperty float ny\nproperty list uchar float nz\n"), ":9", {"\"nz\""}},
       {lines("element face 1\nproperty int vertex_indices\n"), ":4", {"found a number, expected a list"}},
       {lines(kOneFace + "property float texcoord\n"), ":5", {"found a number, expected a list for \"texcoord\""}},
       {header(binary(kBig), "element vertex 4294967295\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"),
        ", byte 121",
        {"found 0 bytes"}}});
}

TEST_CASE("bad numbers of a PLY text are refused with their line", "[unit]") {
  const std::string start = header("ascii", kThree + kOneFace);
  expect_all(
      {{start + "0 0 x\n" + kCorners, ":10", {"found \"x\", expected a number for \"z\""}},
       {start + "0 0 1,5\n" + kCorners, ":10", {"found \"1,5\""}},
       {start + "0 nan 0\n" + kCorners, ":10", {"found \"nan\", expected a finite number for \"y\""}},
       {start + "0 0 -inf\n" + kCorners, ":10", {"found \"-inf\""}},
       {start + "0 0 1e39\n" + kCorners, ":10", {"found \"1e39\""}},
       {start + "0 0 1e999\n" + kCorners, ":10", {"found \"1e999\""}},
       {start + "0 0\n" + kCorners, ":10", {"found the end of the line, expected a number for \"z\""}},
       {start + "0 0 0 0\n" + kCorners, ":10", {"found \"0\", expected the end of the line"}},
       {start + kCorners + "3 0 1 3\n", ":13", {"found \"3\", expected a vertex index from 0 to 2"}},
       {start + kCorners + "3 0 1 -1\n", ":13", {"found \"-1\""}},
       {start + kCorners + "3 0 1 1.5\n", ":13", {"found \"1.5\""}},
       {start + kCorners + "3 0 1 nan\n", ":13", {"found \"nan\""}},
       {start + kCorners + "3 0 1 4294967296\n", ":13", {"found \"4294967296\""}},
       {start + kCorners + "-3 0 1 2\n", ":13", {"found \"-3\"", "\"vertex_indices\""}},
       {start + kCorners + "1.5 0 1 2\n", ":13", {"found \"1.5\""}},
       {start + kCorners + "4 0 1 2\n", ":13", {"found \"4\"", "up to the 3"}},
       {start + kCorners + "4 0 1 2    \n", ":13", {"found the end of the line"}},
       {start + kCorners + "99999999999 0 1 2\n", ":13", {"found \"99999999999\""}},
       {start + kCorners + "3 0 1 2 2\n", ":13", {"expected the end of the line"}},
       {start + kCorners + "\n \n\n", ":16", {"found the end of the file, expected another \"face\""}},
       {start + kCorners, ":13", {"found the end of the file, expected another \"face\""}},
       {header("ascii", "element vertex 4000000000\n" + kXyz) + kCorners,
        ":7",
        {"found 19 bytes, expected 4000000000 of element"}},
       {header("ascii", kOneFace) + "3 0 1 2\n", ":6", {"found \"0\"", "there are no vertices"}},
       {header("ascii", kOneFace + kThree) + "3 0 1 7\n" + kCorners, ":10", {"found \"7\""}},
       {header("ascii", kThree + kOneFace + "property list uchar float texcoord\n") + kCorners + "3 0 1 2 4 0 0 0 0\n",
        ":14",
        {"found 4 texture coordinates, expected 6"}},
       {header("ascii", kThree + kOneFace + "property list uchar float texcoord\n") + kCorners +
            "3 0 1 2 6 0 0 0 0 0 nan\n",
        ":14",
        {"found \"nan\""}}});
}

TEST_CASE("bad numbers of a binary PLY file are refused with their byte", "[unit]") {
  for (const std::endian order : {kLittle, kBig}) {
    const std::string start = header(binary(order), kThree + kOneFace);
    const std::string whole = start + corners(order);
    const auto at = [](std::size_t byte) { return ", byte " + std::to_string(byte); };
    const auto face = [&](auto... numbers) { return whole + bytes_of(order, numbers...); };
    const std::string doubles =
        header(binary(order), "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n");
    const std::string ints = header(binary(order), kThree + "element face 1\nproperty list int uint vertex_indices\n");
    expect_all(
        {{start + bytes_of(order, 0.0f, kNan) + std::string(100, '\0'),
          at(start.size() + 4),
          {"found nan, expected a finite number for \"y\""}},
         {doubles + bytes_of(order, 0.0, 0.0, 1e39), at(doubles.size() + 16), {"found 1e+39", "\"z\""}},
         {start + corners(order).substr(1), at(start.size()), {"found 35 bytes, expected 3 of element \"vertex\""}},
         {whole, at(whole.size()), {"found 0 bytes, expected 1 of element \"face\""}},
         {face('\3', 0, 1, 3), at(whole.size() + 9), {"found 3, expected a vertex index from 0 to 2"}},
         {face('\3', 0, -1, 2), at(whole.size() + 5), {"found -1"}},
         {face('\3', 0, 1), at(whole.size()), {"found 3", "up to the 2"}},
         {face('\xff', 0, 1, 2), at(whole.size()), {"found 255"}},
         {ints + corners(order) + bytes_of(order, -1, 0, 1, 2), at(ints.size() + 36), {"found -1"}},
         {ints + corners(order) + bytes_of(order, 3, 0, 1, 0xffffffffu),
          at(ints.size() + 36 + 12),
          {"found 4294967295"}},
         {ints + corners(order) + bytes_of(order, 0x7fffffff, 0), at(ints.size() + 36), {"found 2147483647"}}});
    const std::string after = header(binary(order), kThree + kOneFace + "property double quality\n");
    expect_all({{after + corners(order) + bytes_of(order, '\2', 0, 1, 0.0f),
                 at(after.size() + 36 + 9),
                 {"found the end of the file, expected a number for \"quality\""}}});
  }
}

TEST_CASE("a PLY file cut off anywhere, or with more than it can hold, ends in one line", "[unit]") {
  const InputFolder folder;
  for (const std::string& whole :
       {header("ascii", kThree + kOneFace) + kCorners + "3 0 1 2",
        header(binary(kBig), kThree + kOneFace) + corners(kBig) + bytes_of(kBig, '\3', 0, 1, 2)}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      INFO(size);
      folder.write("mesh.ply", whole.substr(0, size));
      MaterialLibrary library;
      CHECK_THROWS_AS(read_ply_into(library, folder / "mesh.ply", {}), Error);
    }
  }
  for (const std::string count : {"4000000000", "18446744073709551615"}) {
    for (const std::string& format : {std::string("ascii"), binary(kBig)}) {
      for (const std::string& element :
           {"element vertex " + count + "\n" + kXyz, kThree + "element face " + count + "\n" + kIndices,
            "element other " + count + "\nproperty int a\n",
            "element other " + count + "\nproperty list int int a\n"}) {
        INFO(format << element);
        folder.write("mesh.ply", header(format, element) + std::string(50, '0'));
        MaterialLibrary library;
        CHECK_THROWS_AS(read_ply_into(library, folder / "mesh.ply", {}), Error);
      }
    }
  }
}
