#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace raylab::app {

// What raylab-image does, a function each. Results go to standard output; all throw Error.

/// Prints the errors of a picture against a reference, as text or as a JSON object, in which a value that is not
/// finite is null.
void compare(const std::filesystem::path& image, const std::filesystem::path& reference, bool as_json);

/// Writes the picture in another format, its linear values scaled by 2^exposure_stops. Between EXR files the
/// attributes are kept; layers are not.
void convert(const std::filesystem::path& input, const std::filesystem::path& output, double exposure_stops);

/// Prints size, channels, ranges of R, G and B (linear), attributes, and what a film is of. Throws Error (input) after
/// all that where sums of the film are damaged, with their rows.
void info(const std::filesystem::path& file);

/// Writes the picture of relative errors (see error_picture).
void diff(const std::filesystem::path& image, const std::filesystem::path& reference,
          const std::filesystem::path& output, double full_scale);

/// Writes the film of all samples of the parts, which --samples of raylab-render made, and its picture. What is missing
/// is told on standard error. `exr`: half, float, or empty for half where it holds the picture. Layers: variance,
/// samples.
void merge(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& output, const std::string& exr,
           const std::vector<std::string>& layers);

}  // namespace raylab::app
