#include "hud.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include "backends/imgui_impl_glfw.h"
#include "backends/imgui_impl_opengl3.h"

namespace raylab {

namespace {

constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
constexpr float kMargin = 8.0f;

double millions_a_second(std::uint64_t count, double seconds) {
  return seconds > 0.0 ? 1e-6 * static_cast<double>(count) / seconds : 0.0;
}

void show_traced(const char* label, const TracedPicture& picture, std::uint32_t wanted) {
  ImGui::Text("%s%u of %u spp%s", label, picture.samples, wanted,
              picture.complete       ? ", done"
              : picture.samples == 0 ? ", coarse"
                                     : "");
  ImGui::Text("%.2f Mrays/s  %.2f Mpaths/s", millions_a_second(picture.stats.rays.total(), picture.seconds),
              millions_a_second(picture.stats.rays.camera, picture.seconds));
  if (picture.estimated_relmse < kInfinity) ImGui::Text("estimated relMSE %.3g", picture.estimated_relmse);
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
  ImGui::Text("focus %.4g  defocus %.3g deg  vfov %.3g deg", c.focus_distance, c.defocus_angle, c.vfov);
  ImGui::Text("speed %.3g/s%s", explorer.speed(), explorer.pivot() ? "  orbiting" : "");
}

void show_materials(const Scene& scene) {
  if (!ImGui::CollapsingHeader("materials")) return;
  ImGui::BeginChild("list", ImVec2(300.0f, 160.0f));
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const Rgb c = m.color.kind == Texture::Kind::image ? scene.textures[m.color.image].mean : m.color.a;
    ImGui::PushID(static_cast<int>(i));
    ImGui::ColorButton("", ImVec4(linear_to_srgb(c.r), linear_to_srgb(c.g), linear_to_srgb(c.b), 1.0f),
                       ImGuiColorEditFlags_NoTooltip, ImVec2(14.0f, 14.0f));
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
    ImGui::Text("%-20s %s", line.keys, line.what);
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
  ImGui::Text("%s  %s  %dx%d  %.1f ms", scene.name.c_str(), traced ? "path traced" : "raster", figures.width,
              figures.height, 1e3 * figures.frame_seconds);
  if (!traced) ImGui::Text("%zu triangles drawn", figures.triangles_drawn);
  const bool both = traced && explorer.compare() != Compare::off;
  show_accelerator(shelf, explorer.accel(), both ? "left  " : "");
  if (traced && figures.picture) show_traced("", *figures.picture, figures.samples_wanted);
  if (both) {
    show_accelerator(shelf, explorer.other_accel(), "right ");
    if (figures.other) show_traced("", *figures.other, figures.samples_wanted);
    ImGui::Text("%s", figures.comparison.c_str());
  }
  if (traced) ImGui::Text("ends at most %.0f ms after a move", 1e3 * figures.longest_stop_seconds);
  if (traced) {
    show_pixel(both ? "left  " : "", figures.picture.get(), explorer, figures);
    if (both) show_pixel("right ", figures.other.get(), explorer, figures);
    if (explorer.exposure() != 0.0) ImGui::Text("exposure %+g stops, on the screen alone", explorer.exposure());
  }
  show_camera(explorer.camera(), explorer);
  show_materials(scene);
  if (!figures.failure.empty()) ImGui::TextWrapped("%s", figures.failure.c_str());
  ImGui::TextDisabled("H help");
  ImGui::End();
}

}  // namespace

Hud::Hud(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui::StyleColorsDark();
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
