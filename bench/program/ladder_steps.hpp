#pragma once
// The steps between the book's tree and `bvh`, each a small accelerator that adds one idea to the one before. They
// are here to be measured and read, not to be used: the triangle test is the book's, faults included, and the box
// test lets NaN pass as inside.
#include "raylab/accel/accelerator.hpp"

namespace raylab::bench {

/// The book's tree (longest axis, median of a full sort, one primitive a leaf) in one array, traversed with a
/// stack, the nearer child first.
std::unique_ptr<Accelerator> make_flat(const Geometry& geometry, const AcceleratorOptions& options);

/// The same traversal, of a tree that is split where the surface area heuristic says so (binned; Wald 2007, "On
/// fast Construction of SAH-based Bounding Volume Hierarchies"), down to four primitives a leaf.
std::unique_ptr<Accelerator> make_heuristic(const Geometry& geometry, const AcceleratorOptions& options);

/// That tree with eight children a node, tested at once and visited in the order of their distance (Dammertz,
/// Hanika and Keller 2008, "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays").
std::unique_ptr<Accelerator> make_wide(const Geometry& geometry, const AcceleratorOptions& options);

}  // namespace raylab::bench
