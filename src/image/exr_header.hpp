#pragma once
// What the files of OpenEXR's have in common: headers that are held against the file before OpenEXR makes room.
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfTestFile.h>

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "formats.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab::detail {

std::string one_line(std::string text);

/// The headers of all parts, without the memory that OpenEXR sets aside for reading the pixels.
std::vector<Imf::Header> read_exr_headers(const std::filesystem::path& file);

/// Throws where reading the pixels would take more memory than such a file may, before any is asked for.
void check_exr_memory(const Imf::Header& header, const std::filesystem::path& file);

Attributes string_attributes(const Imf::Header& header);

/// Calls read; whatever OpenEXR throws becomes Error (input).
template <class Read>
auto with_exr(const std::filesystem::path& file, const Read& read) {
  open_input(file);  // for the system's reason when it cannot
  if (!Imf::isOpenExrFile(file.c_str())) throw Error(ErrorKind::input, file.string(), "not an OpenEXR file");
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, file.string(), "not readable as OpenEXR: " + one_line(e.what()));
  }
}

struct ExrSize {
  std::int64_t width, height;
};
inline ExrSize size_of(const Imath::Box2i& window) {
  return {std::int64_t{window.max.x} - window.min.x + 1, std::int64_t{window.max.y} - window.min.y + 1};
}

}  // namespace raylab::detail
