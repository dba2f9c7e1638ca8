#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "gltf_document.hpp"
#include "raylab/core/vec.hpp"

namespace raylab {

/// The elements of an accessor, of which every one can be read.
struct GltfElements {
  std::string_view bytes;
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes from one element to the next
  int component_type = TINYGLTF_COMPONENT_TYPE_FLOAT;
  bool normalized = false;
  std::vector<float> own;  ///< what `bytes` shows where they stand in no buffer as they are
};

/// Number of elements of an accessor of scalars or vectors. `what` names its use in messages. Throws Error (input)
/// where it is not `type`, of another component type than its use takes, or does not lie within its buffers.
std::size_t checked_count(const GltfDocument& document, int accessor, int type, const std::string& what);

/// The elements of an accessor that was checked, which take memory of their own where it is sparse or has no
/// bufferView. Throws Error (input) for a sparse index out of range.
GltfElements elements_of(const GltfDocument& document, int accessor);

namespace detail {

template <class T>
T gltf_component(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

template <int N, class T, class Visit>
void for_each_gltf_vector(const GltfElements& elements, const Visit& visit) {
  const char* at = elements.bytes.data();
  for (std::size_t i = 0; i < elements.count; ++i, at += elements.stride) {
    glm::vec<N, float> value;
    for (int c = 0; c < N; ++c) {
      const T component = gltf_component<T>(at + c * sizeof(T));
      value[c] = static_cast<float>(component);
      if constexpr (std::numeric_limits<T>::is_integer) {
        constexpr double most = static_cast<double>(std::numeric_limits<T>::max());
        if (elements.normalized) value[c] = static_cast<float>(std::max(component / most, -1.0));
      }
    }
    visit(value);
  }
}

}  // namespace detail

/// Calls visit with each element in order, as vector of N floats.
template <int N, class Visit>
void for_each_vector(const GltfElements& elements, const Visit& visit) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return detail::for_each_gltf_vector<N, std::int8_t>(elements, visit);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return detail::for_each_gltf_vector<N, std::uint8_t>(elements, visit);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return detail::for_each_gltf_vector<N, std::int16_t>(elements, visit);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return detail::for_each_gltf_vector<N, std::uint16_t>(elements, visit);
    default:
      return detail::for_each_gltf_vector<N, float>(elements, visit);
  }
}

/// Element i of scalars that are unsigned integers, given as index(i) to `use`.
template <class Use>
void with_indices(const GltfElements& elements, const Use& use) {
  const auto read = [&]<class T>(T) {
    use([data = elements.bytes.data(), stride = elements.stride](std::size_t i) {
      return static_cast<std::uint32_t>(detail::gltf_component<T>(data + i * stride));
    });
  };
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read(std::uint16_t{});
    default:
      return read(std::uint32_t{});
  }
}

}  // namespace raylab
