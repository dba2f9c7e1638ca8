#pragma once
#include <string>

#include "mouse.hpp"

struct GLFWwindow;

namespace raylab {

/// GLFW, started and ended.
class WindowSystem {
 public:
  /// Throws Error (failure) where there is no display.
  WindowSystem();
  ~WindowSystem();
  WindowSystem(const WindowSystem&) = delete;
  WindowSystem& operator=(const WindowSystem&) = delete;
};

/// How the keyboard that is used calls the key: on a French one Key::w is Z.
std::string keyboard_key_name(Key key);

/// A window with a current OpenGL 3.3 context, whose keys and mouse go to an explorer.
class Window {
 public:
  /// Throws Error (failure) without a display that can do OpenGL 3.3. `vsync`: frames wait for the screen.
  Window(const std::string& title, int width, int height, bool vsync, Explorer& explorer);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles what has happened; waits for it at most so long where nothing has. Returns whether anything had: a key,
  /// the mouse, or the window itself.
  bool poll(double wait_seconds);
  void swap();

  /// Size in pixels; 0 x 0 while minimised.
  void size(int& width, int& height) const;
  void resize(int width, int height);
  void minimise();
  void restore();
  void ask_to_close();
  /// As if the pointer had moved by so many pixels.
  void move_mouse(double dx, double dy) { mouse_.move_by(dx, dy); }
  bool closing() const;

  /// By how much the monitor wants text larger than in pixels of old: 2 where its pixels are half as large.
  float text_scale() const;
  /// Units of the window to a pixel of the picture, at most 1.
  float units_per_pixel() const;

  GLFWwindow* handle() const { return window_; }

 private:
  void update_capture();
  void on_key(int key, int action);
  void on_button(int button, int action);
  void on_move(double x, double y);
  /// Pixels of the picture from the cursor's place, which counts in the window's units.
  glm::dvec2 pixels(double x, double y) const;

  GLFWwindow* window_;
  Explorer& explorer_;
  Mouse mouse_;
  bool captured_ = false;
  bool heard_ = false;    // of something, since the last poll
  bool entered_ = false;  // the pointer, and where is not heard of yet
};

}  // namespace raylab
