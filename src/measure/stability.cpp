#include "raylab/measure/stability.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

std::vector<StabilityCase> all_cases() {
  using Part = std::vector<StabilityCase> (*)();
  constexpr std::pair<const char*, Part> kParts[] = {
      {"triangles", stability_triangle_cases}, {"leaks", stability_leak_cases},
      {"spheres", stability_sphere_cases},     {"traversal", stability_traversal_cases},
      {"queries", stability_query_cases},      {"leaving surfaces", stability_offset_cases},
      {"light", stability_light_cases},        {"lamps", stability_lamp_cases},
      {"sampling", stability_sampling_cases},  {"pictures", stability_film_cases}};
  std::vector<StabilityCase> all;
  for (const auto& [theme, part] : kParts) {
    for (StabilityCase& tried : part()) {
      tried.theme = theme;
      all.push_back(std::move(tried));
    }
  }
  std::sort(all.begin(), all.end(), [](const StabilityCase& a, const StabilityCase& b) { return a.id < b.id; });
  return all;
}

/// Calls add() for the accelerators chosen, or for all but the exact one, with each triangle test and each
/// instruction set of those that have a choice.
template <class Add>
void for_each_accelerator(const StabilityChoice& choice, const Add& add) {
  std::vector<std::string> names = choice.accels;
  if (names.empty()) {
    for (const AcceleratorEntry& entry : accelerators()) {
      if (!entry.capabilities.is_exact) names.push_back(entry.name);
    }
  }
  std::vector<std::optional<Intersector>> tests(choice.intersectors.begin(), choice.intersectors.end());
  if (tests.empty()) tests = {Intersector::book, Intersector::fast, Intersector::watertight};
  std::vector<std::optional<Isa>> isas(choice.isas.begin(), choice.isas.end());
  if (isas.empty()) isas = {std::nullopt};
  for (const std::string& name : names) {
    const AcceleratorCapabilities can = find_accelerator(name).capabilities;
    StabilityMethod method;
    method.accel = name;
    for (const auto& test : can.takes_intersector ? tests : std::vector<std::optional<Intersector>>{{}}) {
      for (const auto& isa : can.takes_isa ? isas : std::vector<std::optional<Isa>>{{}}) {
        method.intersector = test;
        method.isa = isa;
        add(method);
      }
    }
  }
}

}  // namespace

AcceleratorOptions StabilityMethod::options() const {
  AcceleratorOptions options;
  options.intersector = intersector;
  options.isa = isa;
  options.quality = quality;
  return options;
}

std::string StabilityMethod::name() const {
  std::string name = accel;
  const auto add = [&](std::string_view part) { name.append(name.empty() ? "" : " ").append(part); };
  if (intersector) add(intersector_name(*intersector));
  if (isa) add(isa_name(*isa));
  if (quality) add(format("%s quality", std::string(quality_name(*quality)).c_str()));
  if (integrator) add(integrator_name(*integrator));
  if (ray_offset) add(*ray_offset == RayOffset::book ? "book offset" : "bounds offset");
  if (batch && *batch) add("batch");
  return name.empty() ? "raylab" : name;
}

void add_fields(Row& row, const StabilityMethod& method) {
  if (!method.accel.empty()) row["accel"] = method.accel;
  if (method.intersector) row["intersector"] = intersector_name(*method.intersector);
  if (method.isa) row["isa_asked"] = isa_name(*method.isa);
  if (method.quality) row["quality"] = quality_name(*method.quality);
  if (method.batch) row["queries"] = *method.batch ? "batch" : "single";
  if (method.integrator) row["integrator"] = integrator_name(*method.integrator);
  if (method.ray_offset) row["ray_offset"] = *method.ray_offset == RayOffset::book ? "book" : "bounds";
}

bool StabilityCase::holds_at(double value) const {
  const double slack = 1e-9 * std::abs(value);  // powers of ten are rounded
  return value >= holds_from - slack && value <= holds_to + slack;
}

std::span<const StabilityCase> stability_cases() {
  static const std::vector<StabilityCase> cases = all_cases();
  return cases;
}

const StabilityCase& find_stability_case(std::string_view name) {
  std::vector<std::string> names;
  for (const StabilityCase& tried : stability_cases()) {
    if (tried.name == name || std::to_string(tried.id) == name) return tried;
    names.push_back(tried.name);
  }
  throw Error(ErrorKind::usage, "--case",
              "no such case '" + std::string(name) + "'. Did you mean '" + nearest_name(name, names) + "'?");
}

std::vector<StabilityMethod> stability_methods(const StabilityCase& tried, const StabilityChoice& choice) {
  std::vector<StabilityMethod> methods;
  StabilityChoice of_pictures = choice;
  if (choice.accels.empty()) of_pictures.accels = {kDefaultAccelerator};
  of_pictures.intersectors = {Intersector::watertight};
  switch (tried.methods) {
    case StabilityMethods::queries:
      for_each_accelerator(choice, [&](StabilityMethod method) {
        for (const bool batch : {false, true}) {
          method.batch = batch;
          methods.push_back(method);
        }
      });
      break;
    case StabilityMethods::batches:
      for_each_accelerator(choice, [&](const StabilityMethod& method) { methods.push_back(method); });
      break;
    case StabilityMethods::qualities:
      for_each_accelerator({choice.accels, {Intersector::watertight}, {}}, [&](StabilityMethod method) {
        if (!find_accelerator(method.accel).capabilities.takes_quality) return;
        for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best}) {
          method.quality = quality;
          methods.push_back(method);
        }
      });
      break;
    case StabilityMethods::offsets:
      for (const RayOffset offset : {RayOffset::bounds, RayOffset::book}) {
        methods.emplace_back();
        methods.back().accel.clear();  // the cases try all
        methods.back().ray_offset = offset;
      }
      break;
    case StabilityMethods::renders:
    case StabilityMethods::paths:
      for_each_accelerator(of_pictures, [&](StabilityMethod method) {
        if (choice.accels.empty()) method.intersector.reset();
        for (const auto integrator : {IntegratorKind::path, IntegratorKind::book, IntegratorKind::reference}) {
          for (const RayOffset offset : {RayOffset::bounds, RayOffset::book}) {
            // It has the bits of `path`: once is enough to see that.
            if (integrator == IntegratorKind::reference && offset == RayOffset::book) continue;
            if (integrator == IntegratorKind::book && tried.methods == StabilityMethods::paths) continue;
            method.integrator = integrator;
            method.ray_offset = offset;
            methods.push_back(method);
          }
        }
      });
      break;
    case StabilityMethods::ours:
      methods.emplace_back();
      methods.back().accel.clear();
      break;
  }
  return methods;
}

StabilityMethod default_stability_method(const StabilityCase& tried) {
  StabilityMethod method = stability_methods(tried, {{kDefaultAccelerator}, {Intersector::watertight}, {}}).front();
  if (tried.methods == StabilityMethods::renders || tried.methods == StabilityMethods::paths)
    method.intersector.reset();
  if (tried.methods == StabilityMethods::qualities) method.quality = BuildQuality::balanced;
  return method;
}

}  // namespace raylab
