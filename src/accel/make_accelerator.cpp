// The table of accelerators by name.
#include <algorithm>
#include <array>
#include <numeric>

#include "backends.hpp"
#include "raylab/core/error.hpp"

namespace raylab {

namespace {

/// Built on first use, so that registrations from other source files always follow the built-in ones.
std::vector<AcceleratorEntry>& table() {
  static std::vector<AcceleratorEntry> entries = {
      {"list", "tests every primitive", make_list},
      {"rtiow", "the BVH of Ray Tracing: The Next Week, faults included", make_rtiow},
      {"embree", "Intel Embree in its default, fast mode", make_embree},
      {"embree-robust", "Intel Embree in its robust mode", make_embree_robust},
  };
  return entries;
}

/// Levenshtein distance: insertions, deletions and substitutions that turn one into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

[[noreturn]] void throw_unknown(const char* option, std::string_view found, const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
    return edit_distance(found, a) < edit_distance(found, b);
  });
  throw Error(ErrorKind::usage, option,
              "no such choice '" + std::string(found) + "'; expected one of " + list + ". Did you mean '" +
                  *nearest + "'?");
}

struct NamedIntersector {
  Intersector intersector;
  std::string_view name;
};
constexpr std::array<NamedIntersector, 3> kIntersectors = {{
    {Intersector::book, "book"},
    {Intersector::fast, "fast"},
    {Intersector::watertight, "watertight"},
}};

}  // namespace

std::span<const AcceleratorEntry> accelerators() { return table(); }

std::unique_ptr<Accelerator> make_accelerator(std::string_view name, const Geometry& geometry,
                                              const AcceleratorOptions& options) {
  std::vector<std::string> names;
  for (const AcceleratorEntry& entry : table()) {
    if (entry.name == name) return entry.make(geometry, options);
    names.push_back(entry.name);
  }
  throw_unknown("--accel", name, names);
}

RegisterAccelerator::RegisterAccelerator(AcceleratorEntry entry) {
  for (const AcceleratorEntry& known : table()) {
    if (known.name == entry.name) {
      throw Error(ErrorKind::usage, "accelerator '" + entry.name + "'", "the name is already taken");
    }
  }
  table().push_back(std::move(entry));
}

std::string_view intersector_name(Intersector intersector) {
  return kIntersectors[static_cast<std::size_t>(intersector)].name;
}

Intersector parse_intersector(std::string_view name) {
  std::vector<std::string> names;
  for (const NamedIntersector& known : kIntersectors) {
    if (known.name == name) return known.intersector;
    names.emplace_back(known.name);
  }
  throw_unknown("--intersector", name, names);
}

}  // namespace raylab
