// Light over spheres: the ways that are solved for against rays traced one by one, and pictures against pictures.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "catch.hpp"
#include "render/sphere_chain_lanes.hpp"
#include "render/sphere_chains.hpp"
#include "strategies.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr double kPiD = std::numbers::pi;

/// A sphere of radius 1 around the origin, and two points outside.
struct Case {
  int crossings;
  double index;
  dvec3 p, light;
};

Case random_case(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto outside = [&] {
    const double z = 2.0 * unit(random) - 1.0, turn = 2.0 * kPiD * unit(random), r = std::sqrt(1.0 - z * z);
    return (1.0 + std::exp(6.0 * unit(random) - 4.0)) * dvec3(r * std::cos(turn), r * std::sin(turn), z);
  };
  Case c{static_cast<int>(3.0 * unit(random)), 1.0 + 1.2 * unit(random), outside(), outside()};
  if (c.crossings == 2) {
    c.index += 0.3;
    c.p *= 1.2;
    c.light *= 1.2;
  }
  // Where there are more ways than one is close to the axis.
  if (unit(random) < 0.5) {
    c.light =
        glm::length(c.light) * glm::normalize((c.crossings == 1 ? -1.0 : 1.0) * glm::normalize(c.p) + 0.1 * outside());
  }
  // The coordinates that float has.
  c.p = dvec3(vec3(c.p));
  c.light = dvec3(vec3(c.light));
  c.index = static_cast<double>(static_cast<float>(c.index));
  return c;
}

ChainEnds<float> ends_of(const Case& c) {
  const SphereChain<float> chain{Vec3<float>(0.0f), 1.0f, static_cast<float>(c.index), static_cast<float>(c.crossings)};
  return chain_ends<float>(chain, Vec3<float>(vec3(c.p)), Vec3<float>(vec3(c.light)), false);
}

/// How far the ends of a way at distance b from the centre lie apart, less how far they should, both without pi for
/// each crossing. Negative b is on the other side of the axis.
double beyond(const Case& c, double b) {
  const double size = std::abs(b), d = glm::length(c.p), far = glm::length(c.light);
  double turn = 2.0 * std::asin(size) - std::asin(size / d) - std::asin(size / far);
  turn -= 2.0 * c.crossings * std::asin(size / c.index);
  const double apart = std::acos(std::clamp(glm::dot(c.p, c.light) / (d * far), -1.0, 1.0));
  return std::copysign(1.0, b) * turn - (c.crossings == 1 ? apart - kPiD : apart);
}

struct Traced {
  dvec3 enters, leaves, direction;
};

/// A ray from p that meets the sphere.
Traced trace(const Case& c, const dvec3& wi) {
  const auto meet = [](const dvec3& o, const dvec3& d, double sign) {
    const double b = glm::dot(o, d);
    return o + (-b + sign * std::sqrt(b * b - glm::dot(o, o) + 1.0)) * d;
  };
  const auto refract = [](const dvec3& d, const dvec3& n, double eta) {
    const double cosine = -glm::dot(d, n);
    return eta * d + (eta * cosine - std::sqrt(1.0 - eta * eta * (1.0 - cosine * cosine))) * n;
  };
  Traced t;
  t.enters = t.leaves = meet(c.p, wi, -1.0);
  t.direction = wi - 2.0 * glm::dot(wi, t.enters) * t.enters;
  if (c.crossings == 0) return t;
  dvec3 inside = refract(wi, t.enters, 1.0 / c.index);
  t.leaves = meet(t.enters, inside, 1.0);
  if (c.crossings == 2) {
    inside -= 2.0 * glm::dot(inside, t.leaves) * t.leaves;
    t.leaves = meet(t.leaves, inside, 1.0);
  }
  t.direction = refract(inside, -t.leaves, c.index);
  return t;
}

/// Where it crosses the plane through the light across `normal`.
dvec3 lands(const Case& c, const dvec3& wi, const dvec3& normal) {
  const Traced t = trace(c, wi);
  return t.leaves + glm::dot(c.light - t.leaves, normal) / glm::dot(t.direction, normal) * t.direction;
}

const Material kMirror = metal(Texture::solid_color({0.9f, 0.8f, 0.7f}), 0.0f);

/// A ball of each material in a row on a floor before a wall. What is seen is the floor beside the first, and not what
/// the balls show of lamps, which is met by chance.
SeenScene balls(const std::vector<Material>& materials) {
  SeenScene s;
  add_quad(s, {-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, lambertian(grey(0.6f)));
  add_quad(s, {-3, 0, -1.5f}, {6, 0, 0}, {0, 3, 0}, lambertian(grey(0.6f)));
  float x = -0.6f;
  for (const Material& material : materials) {
    add_sphere(s, {x, 0.5f, 0}, 0.5f, material);
    x += 1.2f;
  }
  look(s, {0, 2.0f, 3.0f}, {-0.4f, 0, 0.75f}, 8.0f);
  return s;
}

void add_lamp(SeenScene& scene) {
  add_quad(scene, {-0.05f, 2.5f, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f}, light(grey(300.0f)));
}

void check_found(const SeenScene& scene, double share_of_error) {
  check_strategy(scene, &Strategies::sphere, 5, share_of_error);
}

}  // namespace

TEST_CASE("ways over a sphere go where they should, and as many are found as there are", "[unit][spheres]") {
  std::mt19937_64 random(1);
  std::array<int, 4> found_of{};
  for (int i = 0; i < 4000; ++i) {
    const Case c = random_case(random);
    constexpr int kSteps = 4000;
    int roots = 0;
    bool clear = true;
    double before = 0.0;
    for (int k = c.crossings > 0 ? -kSteps : 0; k <= kSteps; ++k) {
      const double now = beyond(c, std::sin(0.5 * kPiD * k / kSteps));
      if (k > (c.crossings > 0 ? -kSteps : 0)) {
        roots += (before < 0.0) != (now < 0.0);
        // Near the caustic, or the rim, rounding decides.
        clear = clear && !(std::abs(now) < 2e-3 && (std::abs(now - before) < 2e-4 * 0.5 || std::abs(k) > kSteps - 8));
      }
      before = now;
    }
    const ChainEnds<float> ends = ends_of(c);
    REQUIRE(ends.outside);
    const float told = chain_roots<float>(ends);
    int found = 0;
    for (float k = 0.5f; k < told; k += 1.0f) {
      const SphereWay<float> way = sphere_way<float>(ends, k / told);
      if (!way.found) continue;
      ++found;
      if (!clear) continue;
      const dvec3 wi = glm::normalize(dvec3(vec3(way.wi)));
      INFO(i << ": " << c.crossings << ", index " << c.index << ", cosine " << way.cosine);
      CHECK(glm::length(dvec3(vec3(way.wi)) - wi) < 1e-5);
      const Traced t = trace(c, wi);
      CHECK(glm::length(t.enters - dvec3(vec3(way.enters))) < 2e-3);
      CHECK(glm::length(t.leaves - dvec3(vec3(way.leaves))) < 2e-3);
      CHECK(glm::length(t.direction - dvec3(vec3(way.arrives))) < 2e-3);
      const dvec3 to_light = c.light - t.leaves;
      CHECK(glm::length(glm::cross(to_light, t.direction)) < 2e-3 * (1.0 + glm::length(to_light)));
      // How much a cone of directions spreads until it meets the light's plane.
      if (way.cosine < 0.1f) continue;
      const dvec3 x = glm::normalize(glm::cross(wi, std::abs(wi.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
      const dvec3 y = glm::cross(wi, x);
      constexpr double kStep = 1e-6;
      const dvec3 n = glm::normalize(dvec3(vec3(way.arrives)));
      const auto across = [&](const dvec3& d) {
        return (lands(c, glm::normalize(wi + kStep * d), n) - lands(c, glm::normalize(wi - kStep * d), n)) /
               (2.0 * kStep);
      };
      const double spread = std::abs(glm::dot(glm::cross(across(x), across(y)), n));
      const double far2 = glm::dot(c.light, c.light);
      // Its zero is the caustic, where only the absolute error is small.
      CHECK(static_cast<double>(way.spread * told) * far2 == Approx(spread).epsilon(2e-3).margin(2e-3 * far2));
    }
    if (!clear) continue;
    INFO(i << ": " << c.crossings << ", index " << c.index << ", told " << told);
    CHECK(found == roots);
    ++found_of[static_cast<std::size_t>(found)];
  }
  // The cases are of all kinds.
  CHECK(std::ranges::min(found_of) > 100);
}

TEST_CASE("rows of spheres are chosen with their probabilities", "[unit][spheres]") {
  SeenScene scene = balls({kMirror, glass()});
  const SphereChains chains(scene);
  REQUIRE(chains.count() == 4);  // off metal, through glass once, off it, and through twice
  const SphereChainTable& table = chains.table();
  const auto column = [&](int k, int row) { return table.columns[k][row]; };
  const Vec3<float> p(0.3f, 0.1f, 0.9f);
  double sum = 0.0;
  std::vector<double> probability;
  for (std::uint32_t row = 0; row < 4; ++row) {
    probability.push_back(static_cast<double>(chain_choice<float>(4, column, p, row)));
    sum += probability.back();
  }
  CHECK(sum == Approx(1.0).epsilon(1e-6));
  constexpr int kNumbers = 10000;
  std::vector<int> chosen(4);
  for (int i = 0; i < kNumbers; ++i) {
    const ChosenChain<float> c = choose_chain<float>(4, column, p, (static_cast<float>(i) + 0.5f) / kNumbers);
    REQUIRE(c.row < 4);
    CHECK((c.left >= 0.0f && c.left < 1.0f));
    CHECK(static_cast<double>(c.probability) == Approx(probability[c.row]).epsilon(1e-6));
    ++chosen[c.row];
  }
  for (std::size_t row = 0; row < 4; ++row) CHECK(chosen[row] == Approx(kNumbers * probability[row]).margin(2.0));
  // Within the glass ball there is no way over it.
  const ChosenChain<float> inside = choose_chain<float>(4, column, Vec3<float>(0.6f, 0.5f, 0), 0.5f);
  CHECK(inside.probability == 1.0f);
  CHECK(table.columns[0][inside.row] == -0.6f);
}

TEST_CASE("paths that meet a light over a sphere have the density of its samples", "[unit][spheres]") {
  SeenScene scene = balls({kMirror, glass()});
  add_quad(scene, {0.1f, 1.1f, 0.2f}, {0.3f, 0.1f, 0}, {0, 0.3f, 0.1f}, light(grey(1.0f)));  // near, and turned away
  const Lights lights(scene, scene_needs(scene));
  const SphereChains chains(scene);
  const auto column = [&](int k, int row) { return chains.table().columns[k][row]; };
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::array<int, 4> compared{};
  for (int i = 0; i < 10000; ++i) {
    const vec3 p(3.0f * unit(random) - 1.0f, 3.0f * unit(random) - 1.5f, 3.0f * unit(random) - 1.5f);
    const ChosenChain<float> chosen = choose_chain<float>(4, column, Vec3<float>(p), unit(random));
    const auto row = static_cast<int>(chosen.row);
    const SphereChain<float> over = sphere_chain<float>([&](int k) { return column(k, row); });
    const LightSample from_center = lights.sample(over.center, random(), unit(random));
    const SampledLight<float> point{from_center.wi,  from_center.position, from_center.radiance, from_center.end,
                                    from_center.pdf, from_center.infinite, from_center.ng};
    const LightOverSphere<float> sample = light_over_sphere<float>(over, chosen, Vec3<float>(p), point);
    if (!(sample.pdf > 0.0f)) continue;
    const vec3 leaves = vec3(over.center) + over.radius * vec3(sample.leaves);
    const vec3 way = from_center.position - leaves;
    ChainId chain = 0;
    const std::uint32_t sphere = column(0, row) < 0.0f ? 0 : 1;
    for (float k = 0.0f; k <= over.crossings; ++k) {
      const bool through = over.crossings > 0.0f && (k == 0.0f || k == over.crossings);
      REQUIRE(chains.follow(sphere, !through, chain));
    }
    const SphereChains::Share share =
        chains.share(chain, p, leaves, glm::normalize(way), from_center.position, from_center.ng, false);
    CHECK(share.center == vec3(over.center));
    INFO(i << ": " << over.crossings << " crossings");
    // Where the way leaves at a grazing angle, or near a caustic, the point it leaves at is known to few digits.
    const double density = static_cast<double>(from_center.pdf * share.factor);
    if (glm::dot(glm::normalize(way), vec3(sample.leaves)) < 0.1f) continue;
    CHECK(density == Approx(static_cast<double>(sample.pdf)).epsilon(0.02));
    ++compared[static_cast<std::size_t>(over.crossings)];
  }
  INFO(compared[0] << ", " << compared[1] << ", " << compared[2]);
  CHECK((compared[0] > 500 && compared[1] > 200 && compared[2] > 50));
}

TEST_CASE("a path follows a way over a sphere turn by turn", "[unit][spheres]") {
  const SeenScene scene = balls({kMirror, glass()});
  const SphereChains chains(scene);
  const vec3 p(0, 0, 0), light(0, 2, 0), n(0, -1, 0);
  const auto share = [&](ChainId chain) {
    return chains.share(chain, p, {0.6f, 1, 0}, {-0.5f, 0.86f, 0}, light, n, false).factor;
  };
  ChainId chain = 0;
  CHECK(chains.follow(1, true, chain));  // off the glass
  CHECK(share(chain) > 0.0f);
  CHECK_FALSE(chains.follow(0, true, chain));  // and off the metal: no way over one sphere
  chain = 0;
  CHECK(chains.follow(1, false, chain));  // into the glass
  CHECK(share(chain) == 0.0f);
  ChainId again = chain;
  CHECK(chains.follow(1, true, again));  // reflected inside
  ChainId twice = again;
  CHECK_FALSE(chains.follow(1, true, again));  // and once more
  CHECK(chains.follow(1, false, twice));
  CHECK(share(twice) > 0.0f);
  CHECK(chains.follow(1, false, chain));  // and out
  CHECK(share(chain) > 0.0f);
  chain = 1;  // of mirrors
  CHECK_FALSE(chains.follow(1, true, chain));
}

TEST_CASE("ways through glass are sampled only where nothing else is inside", "[unit][spheres]") {
  SeenScene scene = balls({kMirror, glass()});
  add_sphere(scene, {0.6f, 0.5f, 2.0f}, 1.5f, lambertian(grey(0.5f)));  // touches the glass
  CHECK(SphereChains(scene).count() == 4);
  add_triangle(scene, {{0.6f, 0.5f, 3}, {0.6f, 0.5f, -0.3f}, {0.7f, 3, 3}}, lambertian(grey(0.5f)));
  CHECK(SphereChains(scene).count() == 2);
  SeenScene hollow = balls({kMirror, glass()});
  add_sphere(hollow, {0.6f, 0.5f, 0}, 0.4f, glass());
  // Those through the outer ball are left out, but not those of the inner one, which is all glass.
  CHECK(SphereChains(hollow).count() == 5);
}

TEST_CASE("of a heap of marbles the largest are sampled over", "[unit][spheres]") {
  SeenScene scene = balls({});
  for (int i = 0; i < 200; ++i) {
    const float radius = 0.01f + 0.0001f * i;
    add_sphere(scene, {-2.0f + 0.1f * (i % 40), radius, -1.0f + 0.4f * (i / 40)}, radius, glass());
  }
  const SphereChains chains(scene);
  REQUIRE(chains.count() == SphereChainTable::kMost);
  for (std::size_t row = 0; row < chains.count(); ++row) CHECK(chains.table().columns[3][row] > 0.025f);
  ChainId chain = 0;
  CHECK_FALSE(chains.follow(0, true, chain));
  CHECK(chains.follow(199, true, chain));
}

TEST_CASE("light over a mirror ball is found", "[statistical][spheres]") {
  SeenScene scene = balls({kMirror});
  add_lamp(scene);
  check_found(scene, 0.1);
}

TEST_CASE("light through a glass ball is found", "[statistical][spheres]") {
  SeenScene scene = balls({glass()});
  add_lamp(scene);
  check_found(scene, 0.1);
}

TEST_CASE("light of small round lamps is found over a ball, from near and far", "[statistical][spheres]") {
  SeenScene scene = balls({kMirror});
  add_sphere(scene, {0.5f, 0.6f, 0.4f}, 0.03f, light(grey(50.0f)));
  add_sphere(scene, {0.9f, 40.0f, 20.0f}, 0.3f, light(grey(20000.0f)));
  check_found(scene, 0.1);
}

TEST_CASE("the sun of a picture of the sky is found over a ball", "[statistical][spheres]") {
  SeenScene scene = balls({kMirror});
  set_sky(scene, 64, 32, [](int x, int y) { return x == 20 && y == 4 ? Rgb(3000.0f) : Rgb(0.2f); });
  check_found(scene, 0.3);
}

TEST_CASE("many lamps, which a tree chooses, are found over balls", "[statistical][spheres]") {
  SeenScene scene = balls({kMirror, glass()});
  const Texture pattern = picture(scene, 2, 2, [](int x, int y) { return Rgb(20.0f + 200.0f * x, 100.0f, 50.0f * y); });
  for (int i = 0; i < 30; ++i) {
    const float x = -2.0f + 0.13f * i;
    add_quad(scene, {x, 2.5f, -1.0f + 0.1f * i}, {0.03f, 0, 0}, {0, 0, 0.03f}, light(grey(20.0f * (1 + i % 7))));
    add_quad(scene, {x, 2.8f, 1.0f}, {0.03f, 0, 0}, {0, 0.03f, 0}, light(pattern));
    add_sphere(scene, {x, 2.0f, 0.5f}, 0.01f, light(grey(30.0f * (1 + i % 5))));
  }
  check_found(scene, 0.5);
}

TEST_CASE("two balls, hollow glass and balls within balls keep their light", "[statistical][spheres]") {
  SeenScene scene = balls({kMirror, glass()});
  add_sphere(scene, {0.6f, 0.5f, 0}, 0.4f, glass(1.0f / 1.5f));
  add_sphere(scene, {-0.3f, 0.3f, 1.0f}, 0.3f, glass(1.3f));
  add_sphere(scene, {-0.3f, 0.3f, 1.0f}, 0.1f, metal(grey(0.9f), 0.0f));
  add_sphere(scene, {0.2f, 0.2f, 1.2f}, 0.2f, glass(1.0f));
  add_lamp(scene);
  check_found(scene, 1.5);
}
