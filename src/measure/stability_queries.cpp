// Queries: ends of intervals, batches, rays of any size and what is no ray.
#include <algorithm>
#include <bit>

#include "raylab/core/parallel.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

bool same_bits(const std::optional<Hit>& a, const std::optional<Hit>& b) {
  return a.has_value() == b.has_value() && (!a || *a == *b);
}

/// The end of the interval so many ulp behind or before the hit: what lies within is met, and occlusion agrees.
StabilityTrial interval_ends(double ulps, std::size_t count, std::uint64_t seed) {
  auto geometry = std::make_shared<const Geometry>(
      Geometry{{triangle_soup(200, 1.0f, 0.4f, seed)}, sphere_soup(20, 1.0f, 0.2f, seed)});
  const std::vector<Ray> rays = random_rays(geometry->bounds(), count, seed + 1);
  return [geometry, rays, ulps](const StabilityMethod& method) {
    const Answers whole = answers_of(method, *geometry, rays);
    std::vector<Ray> cut;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!whole.hits[i]) continue;
      const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(whole.hits[i]->t));
      cut.push_back(rays[i]);
      cut.back().t_max = std::bit_cast<float>(static_cast<std::uint32_t>(bits + static_cast<std::int64_t>(ulps)));
    }
    const Answers found = answers_of(method, *geometry, cut);
    StabilityCount count{0, cut.size()};
    for (std::size_t i = 0; i < cut.size(); ++i) {
      const auto& hit = found.hits[i];
      count.failures += (found.occluded[i] != 0) != hit.has_value() || hit.has_value() != (ulps > 0.0) ||
                        (hit && !(hit->t > cut[i].t_min && hit->t < cut[i].t_max));
    }
    return count;
  };
}

struct SentRays {
  Geometry geometry;
  std::vector<Ray> rays;
};

/// Batches of so many rays against the same rays alone, to the bit: rays in the planes of a box's faces, random ones,
/// ones with ends of any kind, and such as meet spheres of 1e-8.
StabilityTrial batch_sizes(double size, std::size_t count, std::uint64_t seed) {
  auto scenes = std::make_shared<std::vector<SentRays>>();
  const std::size_t part = std::max<std::size_t>(count / 3, 1);
  scenes->push_back({{{box_mesh(vec3(0.0f), vec3(0.01f))}, {}}, rays_in_faces(0.01f, part, seed)});
  Geometry soup{{triangle_soup(300, 1.0f, 0.4f, seed)}, sphere_soup(30, 1.0f, 0.2f, seed)};
  std::vector<Ray> rays = random_rays(soup.bounds(), part, seed + 1);
  UniformFloats uniform(seed + 2);
  for (Ray& ray : rays) {
    if (uniform.below(2) == 1) ray.t_max = uniform(0.0f, 2.0f);
    if (uniform.below(2) == 1) ray.t_min = uniform(0.0f, 1.0f);
  }
  scenes->push_back({std::move(soup), std::move(rays)});
  Geometry tiny{{}, sphere_soup(64, 1e-7f, 1e-8f, seed)};
  std::vector<Ray> at_tiny = random_rays(tiny.bounds(), part, seed + 3);
  scenes->push_back({std::move(tiny), std::move(at_tiny)});
  const auto batch = static_cast<std::size_t>(size);
  return [scenes, batch](const StabilityMethod& method) {
    const FlushDenormals flush;
    StabilityCount found;
    for (const SentRays& scene : *scenes) {
      const auto tested = make_accelerator(method.accel, scene.geometry, method.options());
      const RayArrays arrays(scene.rays);
      for (std::size_t first = 0; first < scene.rays.size(); first += batch) {
        const std::size_t n = std::min(batch, scene.rays.size() - first);
        HitArrays hits(n);
        std::vector<std::uint8_t> occluded(n);
        tested->intersect_batch(arrays.batch(first, n), hits.batch());
        tested->occluded_batch(arrays.batch(first, n), occluded.data());
        for (std::size_t i = 0; i < n; ++i) {
          const Ray& ray = scene.rays[first + i];
          found.failures += !same_bits(hits[i], tested->intersect(ray)) || (occluded[i] != 0) != tested->occluded(ray);
        }
      }
      found.trials += scene.rays.size();
    }
    return found;
  };
}

/// A soup of coordinates from 2^-e to 2^e: is occluded what has a closest hit?
StabilityTrial mixed_magnitudes(double exponent, std::size_t count, std::uint64_t seed) {
  UniformFloats uniform(seed);
  const auto e = static_cast<float>(exponent);
  const auto point = [&] {
    vec3 p;
    for (int k = 0; k < 3; ++k) {
      p[k] = std::ldexp(uniform(1.0f, 2.0f), static_cast<int>(std::lround(uniform(-e, e))));
      if (uniform.below(2) == 1) p[k] = -p[k];
    }
    return p;
  };
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 100; ++i) {
    mesh.positions.insert(mesh.positions.end(), {point(), point(), point()});
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  mesh.pad_positions();
  auto geometry = std::make_shared<const Geometry>(Geometry{{std::move(mesh)}, {}});
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 origin = point();
    rays.push_back({origin, point() - origin});
  }
  std::erase_if(rays, [](const Ray& ray) { return ray.direction == vec3(0.0f); });
  return [geometry, rays](const StabilityMethod& method) {
    const Answers found = answers_of(method, *geometry, rays);
    StabilityCount count{0, rays.size()};
    for (std::size_t i = 0; i < rays.size(); ++i)
      count.failures += (found.occluded[i] != 0) != found.hits[i].has_value();
    return count;
  };
}

/// From so far away at a unit cube, half of the rays away from it; directions of lengths from 1e-30 to 1e30.
StabilityTrial far_origins(double distance, std::size_t count, std::uint64_t seed) {
  KnownRays known{{{box_mesh(vec3(0.0f), vec3(1.0f))}, {}}, {}, {}};
  UniformFloats uniform(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const bool away = i % 2 == 1;
    // No t may overflow, nor become so small that it counts as zero.
    const auto reach = static_cast<float>(std::log10(distance));
    const float length = std::pow(10.0f, uniform(std::max(-30.0f, reach - 37.0f), std::min(30.0f, reach + 36.0f)));
    const float x = uniform(0.1f, 0.9f);
    known.add({{x, uniform(0.1f, 0.9f), -static_cast<float>(distance)}, {0, 0, away ? -length : length}}, {!away});
  }
  return try_known(std::move(known));
}

/// A share of the rays is no ray: those hit nothing, and their neighbours what they hit alone.
StabilityTrial not_rays(double share, std::size_t count, std::uint64_t seed) {
  const std::vector<Ray> faulty = faulty_rays();
  UniformFloats uniform(seed);
  struct Rays {
    Geometry geometry;
    std::vector<Ray> rays;
    std::vector<char> expected;
  };
  auto made = std::make_shared<Rays>();
  made->geometry = {{box_mesh(vec3(0.0f), vec3(1.0f))}, {{{0.3f, 0.4f, 0.5f}, 0.2f}}};
  for (std::size_t i = 0; i < count; ++i) {
    const bool bad = uniform() < static_cast<float>(share);
    const float x = uniform(0.05f, 1.95f);
    made->rays.push_back(bad ? faulty[uniform.below(faulty.size())] : Ray{{x, 0.4f, -2.0f}, {0.0f, 0.0f, 1.0f}});
    made->expected.push_back(!bad && x < 1.0f);
  }
  return [made = std::shared_ptr<const Rays>(std::move(made))](const StabilityMethod& method) {
    const Answers found = answers_of(method, made->geometry, made->rays);
    StabilityCount count{0, made->rays.size()};
    for (std::size_t i = 0; i < made->rays.size(); ++i) {
      const bool expected = made->expected[i] != 0;
      count.failures += found.hits[i].has_value() != expected || (found.occluded[i] != 0) != expected;
    }
    return count;
  };
}

}  // namespace

std::vector<StabilityCase> stability_query_cases() {
  using enum StabilityMethods;
  return {
      {25, "interval-ends", "The ray's end just before or behind its hit",
       "occluded is not intersect, or the hit is outside", "ulp behind the hit", queries, values(-64, -8, -1, 1, 8, 64),
       -64, 64, "", interval_ends},
      {31, "batch-sizes", "The same rays alone and in batches", "another bit", "rays in a batch", batches,
       values(1, 4, 8, 16, 64, 512), 1, 512, "embree", batch_sizes},
      // Beyond, about one of 70,000 rays through the widest soups has an occlusion in bvh that differs from its closest
      // hit; in list none of 500,000 has.
      {32, "mixed-magnitudes", "Triangles and rays of coordinates from 2^-e to 2^e", "occluded is not intersect",
       "exponent e", queries, values(1, 5, 10, 20, 30, 40, 50, 60), 1, 30, "", mixed_magnitudes},
      {37, "far-origins", "Origins far from a unit cube, half of the rays towards it", "missed, or met behind",
       "distance", queries, powers_of_ten(3, 38, 5), 1e3, 1e38, "rtiow book", far_origins},
      {38, "not-rays", "Rays with NaN, infinity or no direction among others", "something hit, or a neighbour changed",
       "share of such rays", queries, values(0.01, 0.1, 0.5, 0.9), 0.01, 0.9, "", not_rays},
  };
}

}  // namespace raylab
