#include "window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <cctype>
#include <cstdlib>
#include <optional>
#include <utility>

#include "raylab/core/error.hpp"

namespace raylab {

namespace {

std::string last_glfw_error() {
  const char* description = nullptr;
  glfwGetError(&description);
  return description == nullptr ? "unknown error" : description;
}

constexpr std::pair<int, Key> kKeys[]{
    {GLFW_KEY_W, Key::w},
    {GLFW_KEY_A, Key::a},
    {GLFW_KEY_S, Key::s},
    {GLFW_KEY_D, Key::d},
    {GLFW_KEY_Q, Key::q},
    {GLFW_KEY_E, Key::e},
    {GLFW_KEY_R, Key::r},
    {GLFW_KEY_F, Key::f},
    {GLFW_KEY_V, Key::v},
    {GLFW_KEY_C, Key::c},
    {GLFW_KEY_B, Key::b},
    {GLFW_KEY_M, Key::m},
    {GLFW_KEY_H, Key::h},
    {GLFW_KEY_P, Key::p},
    {GLFW_KEY_Z, Key::z},
    {GLFW_KEY_X, Key::x},
    {GLFW_KEY_U, Key::u},
    {GLFW_KEY_N, Key::n},
    {GLFW_KEY_F5, Key::f5},
    {GLFW_KEY_MINUS, Key::minus},
    {GLFW_KEY_KP_SUBTRACT, Key::minus},
    {GLFW_KEY_EQUAL, Key::equal},
    {GLFW_KEY_KP_ADD, Key::equal},
    {GLFW_KEY_SPACE, Key::space},
    {GLFW_KEY_TAB, Key::tab},
    {GLFW_KEY_ENTER, Key::enter},
    {GLFW_KEY_KP_ENTER, Key::enter},
    {GLFW_KEY_ESCAPE, Key::escape},
    {GLFW_KEY_HOME, Key::home},
    {GLFW_KEY_BACKSPACE, Key::backspace},
    {GLFW_KEY_PAGE_UP, Key::page_up},
    {GLFW_KEY_PAGE_DOWN, Key::page_down},
    {GLFW_KEY_UP, Key::up},
    {GLFW_KEY_DOWN, Key::down},
    {GLFW_KEY_LEFT_BRACKET, Key::left_bracket},
    {GLFW_KEY_RIGHT_BRACKET, Key::right_bracket},
    {GLFW_KEY_LEFT_SHIFT, Key::shift},
    {GLFW_KEY_RIGHT_SHIFT, Key::shift},
    {GLFW_KEY_LEFT_CONTROL, Key::control},
    {GLFW_KEY_RIGHT_CONTROL, Key::control},
};

std::optional<Key> key_of(int key) {
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) {
    return static_cast<Key>(static_cast<int>(Key::digit1) + (key - GLFW_KEY_1));
  }
  for (const auto& [number, meaning] : kKeys) {
    if (number == key) return meaning;
  }
  return std::nullopt;
}

Window& window_of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool hud_has_mouse() { return ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantCaptureMouse; }

}  // namespace

std::string keyboard_key_name(Key key) {
  for (const auto& [number, meaning] : kKeys) {
    if (meaning != key) continue;
    const char* name = glfwGetKeyName(number, 0);
    if (name == nullptr) break;  // no printable key
    std::string shown = name;
    if (shown.size() == 1) shown[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(shown[0])));
    return shown;
  }
  return plain_key_name(key);
}

WindowSystem::WindowSystem() {
  const bool x11 = is_set("DISPLAY"), wayland = is_set("WAYLAND_DISPLAY");
  if (!x11 && !wayland) {
    throw Error(ErrorKind::failure, "", "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)");
  }
#ifdef GLFW_PLATFORM
  // GLFW 3.4 tries Wayland first, whose library complains on the error stream where it finds no session.
  if (!wayland) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (glfwInit() != GLFW_TRUE) throw Error(ErrorKind::failure, "", "there is no display (" + last_glfw_error() + ")");
}

WindowSystem::~WindowSystem() { glfwTerminate(); }

Window::Window(const std::string& title, int width, int height, bool vsync, Explorer& explorer)
    : explorer_(explorer), mouse_(explorer) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    throw Error(ErrorKind::failure, "", "no window with OpenGL 3.3 could be opened (" + last_glfw_error() + ")");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(vsync ? 1 : 0);
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) { window_of(w).on_key(key, action); });
  glfwSetMouseButtonCallback(
      window_, [](GLFWwindow* w, int button, int action, int) { window_of(w).on_button(button, action); });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { window_of(w).on_move(x, y); });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int entered) {
    window_of(w).heard_ = true;
    window_of(w).entered_ = entered == GLFW_TRUE;
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) {
    window_of(w).heard_ = true;
    if (!hud_has_mouse()) window_of(w).explorer_.scroll(y);
  });
  // Keys that come up while another window has the keyboard are never heard of.
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int focused) {
    window_of(w).heard_ = true;
    if (focused == GLFW_FALSE) window_of(w).explorer_.release_keys();
  });
  // What was covered is to be drawn anew, and a picture of another size too.
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { window_of(w).heard_ = true; });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { window_of(w).heard_ = true; });
  glfwSetWindowIconifyCallback(window_, [](GLFWwindow* w, int) { window_of(w).heard_ = true; });
}

Window::~Window() { glfwDestroyWindow(window_); }

void Window::on_key(int key, int action) {
  heard_ = true;
  const std::optional<Key> known = key_of(key);
  if (!known) return;
  if (action == GLFW_PRESS) explorer_.key_down(*known);
  if (action == GLFW_RELEASE) explorer_.key_up(*known);
}

void Window::on_button(int button, int action) {
  heard_ = true;
  if (action == GLFW_RELEASE) return mouse_.release(button == GLFW_MOUSE_BUTTON_LEFT);
  if (!hud_has_mouse()) mouse_.press();
}

void Window::on_move(double x, double y) {
  heard_ = true;
  const glm::dvec2 to = pixels(x, y);
  // Capturing pulls a pointer in from wherever it is; that would throw the camera about.
  if (std::exchange(entered_, false)) return mouse_.put(to.x, to.y);
  mouse_.move_to(to.x, to.y);
}

glm::dvec2 Window::pixels(double x, double y) const {
  int width = 1, height = 1, units_x = 1, units_y = 1;
  glfwGetFramebufferSize(window_, &width, &height);
  glfwGetWindowSize(window_, &units_x, &units_y);
  if (units_x <= 0 || units_y <= 0) return {x, y};
  return glm::dvec2(x, y) * glm::dvec2(width, height) / glm::dvec2(units_x, units_y);
}

void Window::update_capture() {
  if (explorer_.captures_mouse() == captured_) return;
  captured_ = !captured_;
  glfwSetInputMode(window_, GLFW_CURSOR, captured_ ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
  // The pointer's place jumps with the mode; that is no movement.
  double x = 0.0, y = 0.0;
  glfwGetCursorPos(window_, &x, &y);
  const glm::dvec2 at = pixels(x, y);
  mouse_.put(at.x, at.y);
}

bool Window::poll(double wait_seconds) {
  if (wait_seconds > 0.0) {
    glfwWaitEventsTimeout(wait_seconds);
  } else {
    glfwPollEvents();
  }
  update_capture();
  return std::exchange(heard_, false);
}

float Window::text_scale() const {
  float x = 1.0f, y = 1.0f;
  glfwGetWindowContentScale(window_, &x, &y);
  return y;
}

float Window::units_per_pixel() const {
  int width = 1, height = 1, units_x = 1, units_y = 1;
  glfwGetFramebufferSize(window_, &width, &height);
  glfwGetWindowSize(window_, &units_x, &units_y);
  return height > 0 ? static_cast<float>(units_y) / static_cast<float>(height) : 1.0f;
}

void Window::swap() { glfwSwapBuffers(window_); }

void Window::size(int& width, int& height) const {
  glfwGetFramebufferSize(window_, &width, &height);
  if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE) width = height = 0;
}

void Window::resize(int width, int height) { glfwSetWindowSize(window_, width, height); }
void Window::minimise() { glfwIconifyWindow(window_); }
void Window::restore() { glfwRestoreWindow(window_); }
void Window::ask_to_close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
bool Window::closing() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }

}  // namespace raylab
