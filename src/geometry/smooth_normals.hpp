#pragma once
#include "raylab/geometry/geometry.hpp"

namespace raylab {

/// Replaces the shading normals of a mesh: a corner's is the weighted mean of the normals of the faces around its
/// vertex that are reached from its own over edges across which faces differ by at most `degrees` (in [0, 180];
/// Blender's "auto smooth"). Vertices at one place count as one. Faces without area have no part in it. No normals are
/// stored where nothing is smooth.
/// The weights are those that are exact on spheres: Max 1999, "Weights for computing vertex normals from facet
/// normals".
void smooth_normals(TriangleMesh& mesh, float degrees);

}  // namespace raylab
