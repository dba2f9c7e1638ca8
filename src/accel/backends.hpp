#pragma once
// The built-in accelerators, each made by one function of its own source file, and what they share.
#include <memory>

#include "raylab/accel/accelerator.hpp"

namespace raylab {

std::unique_ptr<Accelerator> make_list(const Geometry& geometry, const AcceleratorOptions& options);
std::unique_ptr<Accelerator> make_rtiow(const Geometry& geometry, const AcceleratorOptions& options);
std::unique_ptr<Accelerator> make_bvh(const Geometry& geometry, const AcceleratorOptions& options);
std::unique_ptr<Accelerator> make_embree(const Geometry& geometry, const AcceleratorOptions& options);
std::unique_ptr<Accelerator> make_embree_robust(const Geometry& geometry, const AcceleratorOptions& options);
std::unique_ptr<Accelerator> make_exact(const Geometry& geometry, const AcceleratorOptions& options);

/// Backend<kind>(geometry), for an intersector known only at run time.
template <template <Intersector> class Backend>
std::unique_ptr<Accelerator> make_with_intersector(Intersector intersector, const Geometry& geometry) {
  switch (intersector) {
    case Intersector::book:
      return std::make_unique<Backend<Intersector::book>>(geometry);
    case Intersector::fast:
      return std::make_unique<Backend<Intersector::fast>>(geometry);
    case Intersector::watertight:
      break;
  }
  return std::make_unique<Backend<Intersector::watertight>>(geometry);
}

/// The instruction set that code without a choice at run time was compiled for.
constexpr const char* compiled_isa() {
#if defined(__AVX512F__)
  return "avx512";
#elif defined(__AVX2__)
  return "avx2";
#elif defined(__AVX__)
  return "avx";
#elif defined(__SSE4_2__)
  return "sse4.2";
#elif defined(__ARM_NEON)
  return "neon";
#else
  return "sse2";
#endif
}

}  // namespace raylab
