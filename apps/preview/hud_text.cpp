#include "hud_text.hpp"

#include "raylab/core/text.hpp"

namespace raylab {

namespace {

double millions_a_second(std::uint64_t count, double seconds) {
  return seconds > 0.0 ? 1e-6 * static_cast<double>(count) / seconds : 0.0;
}

}  // namespace

std::vector<std::string> traced_text(const TracedPicture* picture, const std::string& accel, std::uint32_t wanted) {
  if (picture == nullptr) return {"tracing the first picture ..."};
  if (picture->accel != accel) return {"tracing its first picture ... (you still see that of " + picture->accel + ")"};
  std::vector<std::string> lines{picture->samples == 0 ? std::string("a rough picture, until each pixel has a sample")
                                                       : format("%u of %u samples a pixel%s", picture->samples, wanted,
                                                                picture->complete ? ", done" : ""),
                                 format("%.2f million rays and %.2f million paths a second",
                                        millions_a_second(picture->stats.rays.total(), picture->seconds),
                                        millions_a_second(picture->stats.rays.camera, picture->seconds))};
  if (picture->estimated_relmse < kInfinity) {
    lines.push_back(format("estimated error (relMSE) %.3g", picture->estimated_relmse));
  }
  return lines;
}

}  // namespace raylab
