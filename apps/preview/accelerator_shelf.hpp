#pragma once
#include <exception>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

/// The accelerators of one scene, each built when first asked for and then kept. Safe from many threads.
class AcceleratorShelf {
 public:
  /// The geometry must outlive the shelf, and not change but after clear(). Of the options each accelerator is given
  /// those it takes.
  explicit AcceleratorShelf(const Geometry& geometry, const AcceleratorOptions& options = {})
      : geometry_(geometry), options_(options) {}

  /// Builds it where need be, which may take seconds. Throws Error (usage) for an unknown name.
  const Accelerator& get(const std::string& name) {
    if (const Accelerator* there = find(name)) return *there;
    const std::lock_guard building(building_);
    if (const Accelerator* there = find(name)) return *there;
    const AcceleratorEntry entry = find_accelerator(name);
    std::unique_ptr<Accelerator> made = entry.make(geometry_, options_taken(entry, options_));
    const std::lock_guard lock(mutex_);
    return *(made_[name] = std::move(made));
  }

  /// Sees to it that it will be built, without waiting; what goes wrong get() will say.
  void want(const std::string& name) {
    if (find(name) != nullptr) return;
    wanted_.push_back(std::async(std::launch::async, [this, name] {
      try {
        get(name);
      } catch (const std::exception&) {
      }
    }));
  }

  /// Forgets all accelerators, before the geometry changes: none may be in use. Waits for what is being built.
  void clear() {
    wanted_.clear();
    const std::lock_guard lock(mutex_);
    made_.clear();
  }

  /// The accelerator, or null while it is not built. Never waits.
  const Accelerator* find(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto entry = made_.find(name);
    return entry == made_.end() ? nullptr : entry->second.get();
  }

 private:
  const Geometry& geometry_;
  const AcceleratorOptions options_;
  std::mutex building_;  // held while one is built: two at once would slow each other down
  mutable std::mutex mutex_;
  std::map<std::string, std::unique_ptr<Accelerator>> made_;
  std::vector<std::future<void>> wanted_;  // of the thread that calls want(); last, so that it ends first
};

}  // namespace raylab
