// The cases of raylab-bench stability as tests: what is claimed holds, and the methods known to fail do.
#include <algorithm>
#include <set>
#include <string>

#include "catch.hpp"
#include "expect_error.hpp"
#include "raylab/measure/stability.hpp"
#include "raylab/measure/statistics.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

constexpr std::size_t kTrials = 512;
constexpr std::uint64_t kSeed = 7;

/// Methods that are held to what a case claims. `exact` is not asked in batches, where it is the same code, nor where
/// it takes long or answers better than what it is compared with.
std::vector<StabilityMethod> sound_methods(const StabilityCase& tried) {
  std::vector<StabilityMethod> sound;
  switch (tried.methods) {
    case StabilityMethods::queries:
    case StabilityMethods::batches:
      sound = stability_methods(tried, {{"bvh", "list", "exact"}, {Intersector::watertight}, {}});
      std::erase_if(sound, [&](const StabilityMethod& m) {
        return m.accel == "exact" && (m.batch.value_or(false) || tried.name == "same-bits" || tried.name == "copies");
      });
      break;
    case StabilityMethods::renders:
    case StabilityMethods::paths:
      sound = stability_methods(tried);
      std::erase_if(sound, [](const StabilityMethod& m) {
        return m.ray_offset == RayOffset::book || m.integrator == IntegratorKind::reference;
      });
      break;
    default:
      sound = {default_stability_method(tried)};
  }
  return sound;
}

void check_theme(const std::string& theme) {
  std::size_t cases = 0;
  for (const StabilityCase& tried : stability_cases()) {
    if (tried.theme != theme) continue;
    ++cases;
    for (const double value : tried.values) {
      if (!tried.holds_at(value)) continue;
      const StabilityTrial trial = tried.prepare(value, kTrials, kSeed);
      for (const StabilityMethod& method : sound_methods(tried)) {
        const StabilityCount found = trial(method);
        INFO(tried.id << " " << tried.name << ", " << tried.swept << " " << value << ", " << method.name() << ": "
                      << found.failures << " of " << found.trials);
        if (tried.largest_rate > 0.0) {
          CHECK(proportion_interval(found.failures, found.trials, 0.999).low <= tried.largest_rate);
        } else {
          CHECK(found.failures == 0);
        }
      }
    }
  }
  CHECK(cases > 0);
}

}  // namespace

TEST_CASE("there are sixty-six stability cases, each with a name, a sweep and a claim", "[unit]") {
  REQUIRE(stability_cases().size() == 66);
  std::set<std::string> names;
  int id = 0;
  for (const StabilityCase& tried : stability_cases()) {
    INFO(tried.name);
    CHECK(tried.id == ++id);
    CHECK(names.insert(tried.name).second);
    CHECK(std::is_sorted(tried.values.begin(), tried.values.end()));
    CHECK(std::any_of(tried.values.begin(), tried.values.end(), [&](double v) { return tried.holds_at(v); }));
    CHECK(!stability_methods(tried).empty());
    CHECK(&find_stability_case(tried.name) == &tried);
    CHECK(&find_stability_case(std::to_string(tried.id)) == &tried);
  }
  expect_error(ErrorKind::usage, "--case", {"'vertices'"}, [] { (void)find_stability_case("vertex"); });
}

TEST_CASE("a stability case has the same failures for the same seed", "[unit]") {
  const StabilityCase& tried = find_stability_case("edges");
  StabilityMethod book;
  book.accel = "list";
  book.intersector = Intersector::book;
  const StabilityCount once = tried.prepare(1e-3, 1000, 3)(book);
  const StabilityCount again = tried.prepare(1e-3, 1000, 3)(book);
  CHECK(once.failures == again.failures);
  CHECK(once.trials == 1000);
}

TEST_CASE("single triangles and floors are met at any size that is claimed", "[stability]") {
  check_theme("triangles");
}
TEST_CASE("closed meshes leak nowhere", "[stability]") { check_theme("leaks"); }
TEST_CASE("spheres are met near and far, small and large", "[stability]") { check_theme("spheres"); }
TEST_CASE("trees lose nothing", "[stability]") { check_theme("traversal"); }
TEST_CASE("rays of any kind are answered, alone and in batches", "[stability]") { check_theme("queries"); }
TEST_CASE("rays leave surfaces and let no light through", "[stability]") { check_theme("leaving surfaces"); }
TEST_CASE("light adds up in closed rooms, glass and mirrors", "[stability]") { check_theme("light"); }
TEST_CASE("lamps light what is next to them", "[stability]") { check_theme("lamps"); }
TEST_CASE("random numbers and ranges of samples are whole", "[stability]") { check_theme("sampling"); }
TEST_CASE("films, cameras and textures keep what they are given", "[stability]") { check_theme("pictures"); }

TEST_CASE("methods known to fail in a stability case do", "[stability]") {
  std::size_t naive = 0;
  for (const StabilityCase& tried : stability_cases()) {
    if (tried.naive.empty()) continue;
    ++naive;
    std::vector<StabilityMethod> methods = stability_methods(tried);
    const auto known =
        std::find_if(methods.begin(), methods.end(), [&](const StabilityMethod& m) { return m.name() == tried.naive; });
    INFO(tried.id << " " << tried.name << ", " << tried.naive);
    REQUIRE(known != methods.end());
    CHECK(std::any_of(tried.values.begin(), tried.values.end(),
                      [&](double value) { return tried.prepare(value, 2000, kSeed)(*known).failures > 0; }));
  }
  CHECK(naive > 20);
}
