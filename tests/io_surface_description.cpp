// What becomes of what exporters say of a surface.
#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "io/surface_description.hpp"

using namespace raylab;

namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("half of the light of a fuzzy metal turns as little as half of that of its GGX lobe", "[unit]") {
  constexpr int kSamples = 100001;
  for (const float roughness : {0.05f, 0.2f, 0.4f}) {
    const double width = double{roughness} * double{roughness}, fuzz = double{fuzz_of_roughness(roughness)};
    std::vector<double> ggx, fuzzy;  // angles from the mirror direction, seen straight on
    for (int i = 0; i < kSamples; ++i) {
      const double u = (i + 0.5) / kSamples;
      ggx.push_back(2.0 * std::atan(width * std::sqrt(u / (1.0 - u))));
      const double z = 1.0 - 2.0 * u;
      fuzzy.push_back(std::atan2(fuzz * std::sqrt(1.0 - z * z), 1.0 + fuzz * z));
    }
    INFO("roughness " << roughness << ", fuzz " << fuzz);
    CHECK(median(fuzzy) == Approx(median(ggx)).epsilon(0.03));
  }
  CHECK(fuzz_of_roughness(0.0f) == 0.0f);
  CHECK(fuzz_of_roughness(1.0f) == 1.0f);
}

TEST_CASE("a surface becomes the nearest of the materials, and what that cannot show is told", "[unit]") {
  SurfaceDescription surface;
  std::vector<std::string> left_out;
  const auto becomes = [&] {
    left_out.clear();
    return nearest_material(surface, left_out).kind;
  };
  CHECK(becomes() == Material::Kind::lambertian);
  CHECK(left_out.empty());
  surface.roughness = 0.25f;
  CHECK(becomes() == Material::Kind::lambertian);
  CHECK(left_out == std::vector<std::string>{"its gloss (roughness 0.25)"});
  surface.transmission = 0.5f;
  CHECK(becomes() == Material::Kind::dielectric);
  CHECK(left_out.size() == 3);  // its tint, its roughness, and the half that is not clear
  surface.metallic = 0.75f;
  CHECK(becomes() == Material::Kind::metal);
  CHECK(left_out == std::vector<std::string>{"its part that is no metal (0.25)"});
  surface.emission = Texture::solid_color(Rgb(2.0f));
  CHECK(becomes() == Material::Kind::diffuse_light);
  CHECK(left_out == std::vector<std::string>{"what it reflects"});
}
