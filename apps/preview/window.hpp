#pragma once
#include <string>

#include "explorer.hpp"

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

/// A window with a current OpenGL 3.3 context, whose keys and mouse go to an explorer.
class Window {
 public:
  /// Throws Error (failure) without a display that can do OpenGL 3.3. `vsync`: frames wait for the screen.
  Window(const std::string& title, int width, int height, bool vsync, Explorer& explorer);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles what has happened; waits for it at most so long where nothing has.
  void poll(double wait_seconds);
  void swap();

  /// Size in pixels; 0 x 0 while minimised.
  void size(int& width, int& height) const;
  void resize(int width, int height);
  void minimise();
  void restore();
  void ask_to_close();
  bool closing() const;

  GLFWwindow* handle() const { return window_; }

 private:
  void update_capture();
  void on_key(int key, int action);
  void on_button(int button, int action);
  void on_move(double x, double y);

  GLFWwindow* window_;
  Explorer& explorer_;
  bool captured_ = false;
  int looking_ = 0;  // buttons held
  double x_ = 0.0, y_ = 0.0;
  double dragged_ = 0.0;  // pixels since a button went down
};

}  // namespace raylab
