#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "raylab/scene/camera.hpp"

namespace raylab {

/// The text of a scene file with this camera in it: only the numbers that differ change, and every other byte
/// stays. A key the file lacks is added after the last of the camera's. Numbers are the shortest that read back
/// as the same float. `file` is for messages. Throws Error (input) where the text is no scene file's, and Error
/// (failure) where a camera written in an unheard-of way cannot be changed in place.
std::string with_camera(std::string_view text, const std::string& file, const CameraSettings& camera);

/// The text with a [[view]] of this camera after all else. `name` becomes the view's: "view-1", or the next number that
/// no view has. Throws Error as with_camera() does.
std::string with_view(std::string_view text, const std::string& file, const CameraSettings& camera, std::string& name);

/// Writes a camera back to its scene file.
class CameraFile {
 public:
  /// Remembers what the file holds now. Throws Error (input).
  explicit CameraFile(std::filesystem::path file);

  /// A scene file that is yet to be written, with this text and the camera. One that is there is left alone: write()
  /// throws Error (output) then.
  CameraFile(std::filesystem::path file, std::string text)
      : file_(std::move(file)), text_(std::move(text)), new_(true) {}

  /// Replaces the file by with_camera() of it, whole or not at all. Returns whether that changed anything. A file
  /// that no longer holds what was remembered is left alone: throws Error (output), and remembers what it holds
  /// now, so that asking a second time means it. Throws Error (output) too when it cannot be written.
  bool write(const CameraSettings& camera);

  /// Adds a [[view]] with the camera and returns its name; otherwise as write() does.
  std::string add_view(const CameraSettings& camera);

  const std::filesystem::path& file() const { return file_; }

 private:
  void check_unchanged();
  void replace(std::string text);

  std::filesystem::path file_;
  std::string text_;
  bool new_ = false;
};

}  // namespace raylab
