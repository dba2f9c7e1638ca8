#include "hud.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <cmath>

#include "backends/imgui_impl_glfw.h"
#include "backends/imgui_impl_opengl3.h"
#include "hud_text.hpp"
#include "window.hpp"

namespace raylab {

namespace {

constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
constexpr float kMargin = 8.0f;

void show_traced(const TracedPicture* picture, const std::string& accel, std::uint32_t wanted) {
  for (const std::string& line : traced_text(picture, accel, wanted)) ImGui::TextUnformatted(line.c_str());
}

/// The names with the digits that choose them.
void show_accelerators(const Explorer& explorer) {
  for (std::size_t i = 0; i < explorer.accels().size(); ++i) {
    const std::string& name = explorer.accels()[i];
    if (i % 3 != 0) ImGui::SameLine();
    const std::string text = std::to_string(i + 1) + " " + name;
    name == explorer.accel() ? ImGui::TextUnformatted(text.c_str()) : ImGui::TextDisabled("%s", text.c_str());
  }
}

void show_accelerator(const AcceleratorShelf& shelf, const std::string& name, const char* label) {
  const Accelerator* accelerator = shelf.find(name);
  if (accelerator == nullptr) {
    ImGui::Text("%s%s: building ...", label, name.c_str());
    return;
  }
  const BuildReport& build = accelerator->build_report();
  ImGui::Text("%s%s: built in %.3f s, %.1f MB%s%s", label, name.c_str(), build.seconds,
              1e-6 * static_cast<double>(build.bytes), build.isa.empty() ? "" : ", ", build.isa.c_str());
}

void show_camera(const CameraSettings& c, const Explorer& explorer) {
  ImGui::Text("from  %.4g %.4g %.4g", c.look_from.x, c.look_from.y, c.look_from.z);
  ImGui::Text("at    %.4g %.4g %.4g", c.look_at.x, c.look_at.y, c.look_at.z);
  ImGui::Text("field of view %.3g degrees", c.vfov);
  ImGui::Text("focus at %.4g, aperture %.3g degrees", c.focus_distance, c.defocus_angle);
  ImGui::Text("%s, %.3g units a second", explorer.pivot() ? "orbiting" : "flying", explorer.speed());
}

void show_materials(const Scene& scene) {
  if (!ImGui::CollapsingHeader("materials")) return;
  ImGui::BeginChild("list", ImVec2(23.0f * ImGui::GetFontSize(), 12.0f * ImGui::GetFontSize()));
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const Rgb c = m.color.kind == Texture::Kind::image ? scene.textures[m.color.image].mean : m.color.a;
    ImGui::PushID(static_cast<int>(i));
    ImGui::ColorButton("", ImVec4(linear_to_srgb(c.r), linear_to_srgb(c.g), linear_to_srgb(c.b), 1.0f),
                       ImGuiColorEditFlags_NoTooltip, ImVec2(ImGui::GetFontSize(), ImGui::GetFontSize()));
    ImGui::PopID();
    ImGui::SameLine();
    ImGui::Text("%s  %s", m.name.c_str(), kMaterialKindNames[static_cast<std::size_t>(m.kind)]);
  }
  ImGui::EndChild();
}

/// The linear colour that the traced picture has under the pointer.
void show_pixel(const char* label, const TracedPicture* picture, const Explorer& explorer, const HudFigures& figures) {
  const glm::dvec2 at = explorer.pointer();
  if (picture == nullptr || explorer.captures_mouse()) return;
  const auto color = color_at(picture->image, figures.width, figures.height, at);
  if (!color) return;
  ImGui::Text("%spixel %d, %d: %.4g %.4g %.4g linear RGB", label, static_cast<int>(at.x), static_cast<int>(at.y),
              color->r, color->g, color->b);
}

void show_help() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(size.x - kMargin, kMargin), ImGuiCond_Always, ImVec2(1.0f, 0.0f));
  ImGui::Begin("help", nullptr, kPlain);
  for (const KeyHelp& line : key_help()) {
    ImGui::Text("%-20s %s", with_key_names(line.keys, keyboard_key_name).c_str(),
                with_key_names(line.what, keyboard_key_name).c_str());
  }
  ImGui::End();
}

void show_message(const std::string& message) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(kMargin, size.y - kMargin), ImGuiCond_Always, ImVec2(0.0f, 1.0f));
  ImGui::Begin("message", nullptr, kPlain | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(size.x - 4.0f * kMargin);
  ImGui::TextUnformatted(message.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void show_figures(const Scene& scene, const AcceleratorShelf& shelf, const Explorer& explorer,
                  const HudFigures& figures) {
  ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_FirstUseEver);
  ImGui::Begin("raylab", nullptr, kPlain);
  const bool traced = explorer.view() == View::traced;
  ImGui::Text("%s  %s  %d x %d pixels", scene.name.c_str(), traced ? "path traced" : "raster", figures.width,
              figures.height);
  ImGui::Text("%zu triangles, %zu spheres", scene.geometry.triangle_count(), scene.geometry.spheres.size());
  if (!traced && figures.triangles_drawn < scene.geometry.triangle_count()) {
    ImGui::Text("%zu triangles drawn", figures.triangles_drawn);
  }
  show_accelerators(explorer);
  const bool both = traced && explorer.compare() != Compare::off;
  show_accelerator(shelf, explorer.accel(), both ? "left  " : "");
  if (traced) show_traced(figures.picture.get(), explorer.accel(), figures.samples_wanted);
  if (both) {
    show_accelerator(shelf, explorer.other_accel(), "right ");
    show_traced(figures.other.get(), explorer.other_accel(), figures.samples_wanted);
    ImGui::Text("%s", figures.comparison.c_str());
  }
  if (traced) {
    if (figures.longest_stop_seconds > 0.0) {
      ImGui::Text("a new view waited %.0f ms for the old one at most", 1e3 * figures.longest_stop_seconds);
    }
    show_pixel(both ? "left  " : "", figures.picture.get(), explorer, figures);
    if (both) show_pixel("right ", figures.other.get(), explorer, figures);
    if (explorer.exposure() != 0.0) ImGui::Text("exposure %+g stops, on the screen alone", explorer.exposure());
  }
  show_camera(explorer.camera(), explorer);
  show_materials(scene);
  if (!figures.failure.empty()) ImGui::TextWrapped("%s", figures.failure.c_str());
  ImGui::TextDisabled("%s", with_key_names("{h} help, {u} hides this", keyboard_key_name).c_str());
  ImGui::End();
}

}  // namespace

Hud::Hud(GLFWwindow* window, float scale, float units_per_pixel) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui::StyleColorsDark();
  // The text is made in pixels of the screen, and laid out in units of the window.
  ImFontConfig font;
  font.SizePixels = std::round(13.0f * scale);
  ImGui::GetIO().Fonts->AddFontDefault(&font);
  ImGui::GetIO().FontGlobalScale = units_per_pixel;
  ImGui::GetStyle().ScaleAllSizes(scale * units_per_pixel);
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.7f;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Hud::~Hud() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Hud::draw(const Scene& scene, const AcceleratorShelf& shelf, const Explorer& explorer, const HudFigures& figures) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  // The help in place of the figures: a small window has no room for both.
  if (explorer.shows_help()) {
    show_help();
  } else {
    show_figures(scene, shelf, explorer, figures);
  }
  if (!explorer.message().empty()) show_message(explorer.message());
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace raylab
