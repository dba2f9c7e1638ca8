// The table of accelerators by name.
#include <algorithm>
#include <array>
#include <utility>

#include "backends.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"

namespace raylab {

namespace {

/// Beyond, testing every primitive takes minutes and tells nothing new.
constexpr std::size_t kMostForBruteForce = 1000;

/// Embree promises no equal bits of single rays and packets, and sometimes they are not.
constexpr AcceleratorCapabilities kEmbree{.judges_options = false,
                                          .takes_quality = true,
                                          .takes_compact = true,
                                          .batch_equals_single = false,
                                          .bytes_per_primitive = 70.0};

/// Built on first use, so that registrations from other source files always follow the built-in ones.
std::vector<AcceleratorEntry>& table() {
  static std::vector<AcceleratorEntry> entries = {
      {"list",
       "tests every primitive",
       make_list,
       {.judges_options = false,
        .takes_intersector = true,
        .largest_primitives = kMostForBruteForce,
        .bytes_per_primitive = 8.0}},
      {"rtiow",
       "the BVH of Ray Tracing: The Next Week, faults included",
       make_rtiow,
       {.judges_options = false, .takes_intersector = true, .bytes_per_primitive = 231.0}},
      {"bvh",
       "Raylab's own wide BVH, watertight",
       make_bvh,
       {.judges_options = false,
        .takes_intersector = true,
        .takes_quality = true,
        .takes_isa = true,
        .bytes_per_primitive = 34.0}},
      {"embree", "Intel Embree in its default, fast mode", make_embree, kEmbree},
      {"embree-robust", "Intel Embree in its robust mode; of best quality it splits no space", make_embree_robust,
       kEmbree},
      {"exact",
       "decides every hit in exact arithmetic: the judge, and slow",
       make_exact,
       {.judges_options = false, .is_exact = true, .bytes_per_primitive = 27.0}},
  };
  return entries;
}

/// What is wrong with the registrations, to be told to the first who asks for accelerators: they are made before
/// main begins, where an exception would end the process without a word.
std::string& name_clash() {
  static std::string clash;
  return clash;
}
void check_names() {
  if (name_clash().empty()) return;
  throw Error(ErrorKind::usage, std::exchange(name_clash(), {}), "the name is already taken");
}

[[noreturn]] void throw_unknown(const char* option, std::string_view found, const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  throw Error(ErrorKind::usage, option,
              "no such choice '" + std::string(found) + "'; expected one of " + list + ". Did you mean '" +
                  nearest_name(found, names) + "'?");
}

template <class Choice>
struct Named {
  Choice choice;
  std::string_view name;
};
constexpr std::array<Named<Intersector>, 3> kIntersectors = {{
    {Intersector::book, "book"},
    {Intersector::fast, "fast"},
    {Intersector::watertight, "watertight"},
}};
constexpr std::array<Named<BuildQuality>, 3> kQualities = {{
    {BuildQuality::fast, "fast"},
    {BuildQuality::balanced, "balanced"},
    {BuildQuality::best, "best"},
}};
constexpr std::array<Named<Isa>, 4> kIsas = {{
    {Isa::sse42, isa_name(Isa::sse42)},
    {Isa::avx2, isa_name(Isa::avx2)},
    {Isa::avx512, isa_name(Isa::avx512)},
    {Isa::neon, isa_name(Isa::neon)},
}};

template <class Choice, std::size_t count>
Choice parse(const char* option, std::string_view name, const std::array<Named<Choice>, count>& choices) {
  std::vector<std::string> names;
  for (const Named<Choice>& known : choices) {
    if (known.name == name) return known.choice;
    names.emplace_back(known.name);
  }
  throw_unknown(option, name, names);
}

}  // namespace

std::span<const AcceleratorEntry> accelerators() {
  check_names();
  return table();
}

AcceleratorEntry find_accelerator(std::string_view name) {
  check_names();
  std::vector<std::string> names;
  for (const AcceleratorEntry& entry : table()) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  throw_unknown("--accel", name, names);
}

void check_options(const AcceleratorEntry& entry, const AcceleratorOptions& options) {
  if (entry.capabilities.judges_options) return;
  using Capabilities = AcceleratorCapabilities;
  const auto check = [&](bool given, bool Capabilities::*takes, const char* option) {
    if (!given || entry.capabilities.*takes) return;
    std::string others;
    for (const AcceleratorEntry& other : table()) {
      if (other.capabilities.*takes) others += (others.empty() ? "" : ", ") + other.name;
    }
    throw Error(ErrorKind::usage, option, entry.name + " does not take it; expected with one of " + others);
  };
  check(options.intersector.has_value(), &Capabilities::takes_intersector, "--intersector");
  check(options.quality.has_value(), &Capabilities::takes_quality, "--quality");
  check(options.isa.has_value(), &Capabilities::takes_isa, "--isa");
  check(options.compact, &Capabilities::takes_compact, "--compact");
}

AcceleratorOptions options_taken(const AcceleratorEntry& entry, AcceleratorOptions options) {
  const AcceleratorCapabilities& c = entry.capabilities;
  if (!c.takes_intersector) options.intersector.reset();
  if (!c.takes_quality) options.quality.reset();
  if (!c.takes_isa) options.isa.reset();
  options.compact = options.compact && c.takes_compact;
  return options;
}

std::unique_ptr<Accelerator> make_accelerator(std::string_view name, const Geometry& geometry,
                                              const AcceleratorOptions& options) {
  const AcceleratorEntry entry = find_accelerator(name);
  check_options(entry, options);
  return entry.make(geometry, options);
}

RegisterAccelerator::RegisterAccelerator(AcceleratorEntry entry) {
  for (const AcceleratorEntry& known : table()) {
    if (known.name == entry.name) {
      name_clash() = "accelerator '" + entry.name + "'";
      return;
    }
  }
  table().push_back(std::move(entry));
}

std::string_view intersector_name(Intersector intersector) {
  return kIntersectors[static_cast<std::size_t>(intersector)].name;
}
std::string accelerator_choice() {
  std::string names;
  for (const AcceleratorEntry& entry : accelerators()) names += (names.empty() ? "{" : ",") + entry.name;
  return names + "}";
}

Intersector parse_intersector(std::string_view name) { return parse("--intersector", name, kIntersectors); }

std::string_view quality_name(BuildQuality quality) { return kQualities[static_cast<std::size_t>(quality)].name; }
BuildQuality parse_quality(std::string_view name) { return parse("--quality", name, kQualities); }

Isa parse_isa(std::string_view name) { return parse("--isa", name, kIsas); }

}  // namespace raylab
