#pragma once
#include <filesystem>

namespace raylab::app {

// What raylab-image does, a function each. Results go to standard output; all throw Error.

/// Prints the errors of a picture against a reference, as text or as a JSON object, in which a value that is not
/// finite is null.
void compare(const std::filesystem::path& image, const std::filesystem::path& reference, bool as_json);

/// Writes the picture in another format, its linear values scaled by 2^exposure_stops. Between EXR files the
/// attributes are kept; layers are not.
void convert(const std::filesystem::path& input, const std::filesystem::path& output, double exposure_stops);

/// Prints size, channels and attributes.
void info(const std::filesystem::path& file);

/// Writes the picture of relative errors (see error_picture).
void diff(const std::filesystem::path& image, const std::filesystem::path& reference,
          const std::filesystem::path& output, double full_scale);

}  // namespace raylab::app
