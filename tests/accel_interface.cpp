// Accelerators by name: options, reports, registration.
#include <atomic>
#include <iostream>
#include <thread>

#include "catch.hpp"
#include "raylab/accel/accelerator.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/parallel.hpp"
#include "raylab/core/timing.hpp"
#include "raylab/measure/shapes.hpp"

using namespace raylab;

namespace {

/// What the call throws, which must be a usage error.
template <class Call>
std::string usage_error(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::usage);
    return error.what();
  }
  FAIL("no error");
  return {};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::unique_ptr<Accelerator> make_double_list(const Geometry& geometry, const AcceleratorOptions& options) {
  return make_accelerator("list", geometry, options);
}

}  // namespace

TEST_CASE("an unknown accelerator is a usage error that names those there are and the nearest", "[unit]") {
  const std::string message = usage_error([] { make_accelerator("embre", {}); });
  CHECK(contains(message, "'embre'"));
  for (const AcceleratorEntry& entry : accelerators()) CHECK(contains(message, entry.name));
  CHECK(contains(message, "Did you mean 'embree'"));
}

TEST_CASE("intersectors are known by their names and no others", "[unit]") {
  for (const Intersector i : {Intersector::book, Intersector::fast, Intersector::watertight}) {
    CHECK(parse_intersector(intersector_name(i)) == i);
  }
  CHECK(contains(usage_error([] { parse_intersector("watertigth"); }), "Did you mean 'watertight'"));
}

TEST_CASE("every built-in accelerator takes what its capabilities say, and refuses the rest by name", "[unit]") {
  using Capabilities = AcceleratorCapabilities;
  struct Choice {
    const char* option;
    bool Capabilities::*taken;
    AcceleratorOptions options;
  };
  std::vector<Choice> choices{{"--isa", &Capabilities::takes_isa, {.isa = newest_isa()}},
                              {"--compact", &Capabilities::takes_compact, {.compact = true}}};
  for (const Intersector i : {Intersector::book, Intersector::fast, Intersector::watertight}) {
    choices.push_back({"--intersector", &Capabilities::takes_intersector, {.intersector = i}});
  }
  for (const BuildQuality q : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
    choices.push_back({"--quality", &Capabilities::takes_quality, {.quality = q}});
  }
  const Geometry geometry{{icosphere(vec3(0.0f), 1.0f, 2)}, {}};
  for (const char* name : {"list", "rtiow", "bvh", "embree", "embree-robust", "exact"}) {
    const AcceleratorEntry entry = find_accelerator(name);
    for (const Choice& choice : choices) {
      INFO(name << " " << choice.option);
      if (entry.capabilities.*choice.taken) {
        CHECK(make_accelerator(name, geometry, choice.options)->occluded({{0.03f, 0.1f, -2}, {0.01f, 0.02f, 1}}));
        continue;
      }
      const std::string message = usage_error([&] { make_accelerator(name, geometry, choice.options); });
      CHECK(contains(message, choice.option));
      CHECK(contains(message, name));
      CHECK_NOTHROW(make_accelerator(name, geometry, options_taken(entry, choice.options)));
    }
  }
}

TEST_CASE("what a registration does not say it is capable of is passed on, for the accelerator to judge", "[unit]") {
  static AcceleratorOptions given;
  static const RegisterAccelerator registered{
      {"test-judge", "takes what it likes", [](const Geometry& geometry, const AcceleratorOptions& options) {
         given = options;
         if (options.isa) throw Error(ErrorKind::usage, "--isa", "not here");
         return make_accelerator("list", geometry, {options.intersector});
       }}};
  make_accelerator("test-judge", {}, {.intersector = Intersector::fast, .quality = BuildQuality::best});
  CHECK(given.intersector == Intersector::fast);
  CHECK(given.quality == BuildQuality::best);
  CHECK(contains(usage_error([] { make_accelerator("test-judge", {}, {.isa = Isa::sse42}); }), "not here"));
}

TEST_CASE("a registered accelerator can be made by its name, and a name is taken only once", "[unit]") {
  static const RegisterAccelerator registered{{"test-list", "list under another name", make_double_list}};
  const Geometry geometry{{}, {{vec3(0.0f), 1.0f}}};
  CHECK(make_accelerator("test-list", geometry)->occluded({{0, 0, -2}, {0, 0, 1}}));
  CHECK(accelerators().back().name == "test-list");
  // Nothing may be thrown before main() begins; who asks for accelerators is told.
  const auto register_again = [] { RegisterAccelerator{{"list", "", make_double_list}}; };
  const std::size_t count = accelerators().size();
  CHECK_NOTHROW(register_again());
  CHECK(contains(usage_error([] { accelerators(); }), "'list'"));
  CHECK_NOTHROW(register_again());
  CHECK(contains(usage_error([&] { make_accelerator("bvh", geometry); }), "'list'"));
  CHECK(accelerators().size() == count);
}

TEST_CASE("an accelerator is built without a hand on the program's standard output", "[unit]") {
  std::cout.setstate(std::ios::failbit);  // to give it another buffer clears this
  for (const char* name : {"embree", "embree-robust", "bvh"}) make_accelerator(name, {});
  const bool untouched = std::cout.fail();
  std::cout.clear();
  CHECK(untouched);
}

TEST_CASE("build reports say what was built", "[unit]") {
  const Geometry geometry{{icosphere(vec3(0.0f), 1.0f, 3)}, sphere_soup(20, 1.0f, 0.1f, 1)};
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto accelerator = entry.make(geometry, {});
    const BuildReport& report = accelerator->build_report();
    INFO(entry.name);
    CHECK(report.primitives == 1300);
    CHECK(report.invalid_primitives == 0);
    CHECK(report.seconds >= 0.0);
    CHECK(report.seconds < 10.0);
    CHECK(report.bytes >= 1300 * 8);
    CHECK(report.bytes < 1300 * 1000);
    CHECK_FALSE(report.isa.empty());
  }
}

TEST_CASE("the book's tree halves its objects: n leaves in n - 1 nodes, as deep as the logarithm", "[unit]") {
  for (const std::size_t n : {2, 4, 64, 1024}) {
    const Geometry geometry{{triangle_soup(n, 1.0f, 0.1f, 2)}, {}};
    const auto tree = make_accelerator("rtiow", geometry);
    const BuildReport& report = tree->build_report();
    CHECK(report.nodes == n - 1);
    CHECK(std::size_t{1} << (report.depth - 1) == n);
    if (n == 2) CHECK(report.sah_cost == Approx(3.0));  // one box, two objects
    CHECK(report.sah_cost > 1.0);
    CHECK(report.sah_cost < 3.0 * static_cast<double>(n));
  }
  const auto one = make_accelerator("rtiow", Geometry{{}, {{vec3(0.0f), 1.0f}}});
  CHECK(one->build_report().nodes == 1);
  CHECK(one->build_report().depth == 2);
  CHECK(make_accelerator("rtiow", {})->build_report().nodes == 0);
}

TEST_CASE("a mesh whose positions are not padded is accepted by every accelerator", "[unit]") {
  TriangleMesh mesh = triangle_soup(1, 0.1f, 1.0f, 1);
  mesh.positions.shrink_to_fit();
  const Geometry geometry{{mesh}, {}};
  const Triangle t = triangle_corners(mesh, 0);
  const vec3 middle = (t.p0 + t.p1 + t.p2) / 3.0f;
  const vec3 normal = glm::cross(t.p1 - t.p0, t.p2 - t.p0);
  for (const AcceleratorEntry& entry : accelerators()) {
    CHECK(entry.make(geometry, {})->occluded({middle + normal, -normal}));
  }
}

TEST_CASE("a limit of build threads changes no answer", "[unit]") {
  const Geometry geometry{{triangle_soup(500, 1.0f, 0.4f, 3)}, {}};
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto limited = entry.make(geometry, {{}, 1});
    const auto free = entry.make(geometry, {});
    const Ray ray{{0, 0, -3}, {0.01f, 0.02f, 1}};
    CHECK(limited->intersect(ray) == free->intersect(ray));
  }
}

TEST_CASE("a limit of build threads ends with the building", "[unit]") {
  if (hardware_threads() < 2) {
    SUCCEED("this machine has one thread");
    return;
  }
  const Geometry geometry{{triangle_soup(500, 1.0f, 0.4f, 3)}, {}};
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto accelerator = entry.make(geometry, {{}, 1});
    // Two that wait for each other need two threads.
    std::atomic<int> there{0};
    std::atomic<bool> met{true};
    parallel_for(2, [&](std::size_t) {
      ++there;
      const Stopwatch watch;
      while (there < 2 && met) {
        if (watch.seconds() > 20.0) met = false;
        std::this_thread::yield();
      }
    });
    INFO(entry.name);
    CHECK(met);
  }
}
