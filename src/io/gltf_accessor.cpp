#include "gltf_accessor.hpp"

namespace raylab {
namespace {

/// 0 where the type is none of glTF's.
std::size_t size_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

std::size_t components_of(int type) { return type == TINYGLTF_TYPE_SCALAR ? 1 : static_cast<std::size_t>(type); }

std::string type_name(int type) {
  if (type == TINYGLTF_TYPE_SCALAR) return "SCALAR";
  return type <= TINYGLTF_TYPE_VEC4 ? "VEC" + std::to_string(type) : "a matrix";
}

bool is_index_type(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// The bytes of `count` elements, or an error.
std::string_view checked_bytes(const GltfDocument& document, int buffer_view, std::size_t offset, std::size_t count,
                               std::size_t stride, std::size_t size, const std::string& what) {
  const std::string_view bytes = document.view(buffer_view);
  if (count == 0) return {};
  const std::size_t needed = (count - 1) * stride + size;  // count and stride are small enough
  if (offset > bytes.size() || needed > bytes.size() - offset) {
    document.fail(what + ": it goes beyond the end of bufferView " + std::to_string(buffer_view));
  }
  return bytes.substr(offset, needed);
}

/// Of one accessor, with what all that reads it needs.
struct Layout {
  const tinygltf::Accessor& accessor;
  std::size_t size;    // of an element
  std::size_t stride;  // in its bufferView
  std::string what;

  Layout(const GltfDocument& document, int index, std::string name)
      : accessor(document.model().accessors[static_cast<std::size_t>(index)]),
        size(size_of_component(accessor.componentType) * components_of(accessor.type)),
        stride(size),
        what(std::move(name)) {
    if (accessor.bufferView < 0) return;
    document.view(accessor.bufferView);  // for the error where there is none
    const auto view = static_cast<std::size_t>(accessor.bufferView);
    if (const std::size_t given = document.model().bufferViews[view].byteStride; given != 0) stride = given;
  }

  std::string_view bytes(const GltfDocument& document) const {
    return checked_bytes(document, accessor.bufferView, accessor.byteOffset, accessor.count, stride, size, what);
  }
  GltfElements sparse_indices(const GltfDocument& document) const {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    const std::size_t index_size = size_of_component(sparse.indices.componentType);
    GltfElements indices;
    indices.bytes =
        checked_bytes(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                      index_size, index_size, what + ": its sparse indices");
    indices.count = count;
    indices.stride = index_size;
    indices.component_type = sparse.indices.componentType;
    return indices;
  }
  std::string_view sparse_values(const GltfDocument& document) const {
    const auto& sparse = accessor.sparse;
    return checked_bytes(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                         static_cast<std::size_t>(sparse.count), size, size, what + ": its sparse values");
  }
};

std::string name_of(int accessor) { return "accessor " + std::to_string(accessor); }

/// Appends the components of elements that lie in some bytes.
void append(std::string_view bytes, std::size_t count, std::size_t stride, const tinygltf::Accessor& accessor,
            std::vector<float>& values) {
  GltfElements elements{bytes, count, stride, accessor.componentType, accessor.normalized, {}};
  const auto push = [&](const auto& value) {
    for (int c = 0; c < value.length(); ++c) values.push_back(value[c]);
  };
  if (accessor.type == TINYGLTF_TYPE_VEC2) return for_each_vector<2>(elements, push);
  for_each_vector<3>(elements, push);
}

}  // namespace

std::size_t checked_count(const GltfDocument& document, int index, int type, const std::string& what) {
  if (index < 0 || static_cast<std::size_t>(index) >= document.model().accessors.size()) {
    document.fail(what + ": there is no " + name_of(index));
  }
  const Layout layout(document, index, what + " (" + name_of(index) + ")");
  const tinygltf::Accessor& accessor = layout.accessor;
  if (accessor.type != type) {
    document.fail(layout.what + ": found " + type_name(accessor.type) + ", expected " + type_name(type));
  }
  const bool are_indices = type == TINYGLTF_TYPE_SCALAR;
  const bool is_integer = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (layout.size == 0 || (are_indices ? !is_index_type(accessor.componentType) : is_integer)) {
    document.fail(layout.what + ": component type " + std::to_string(accessor.componentType) + " is not supported");
  }
  if (accessor.count > std::numeric_limits<std::uint32_t>::max()) {
    document.fail(layout.what + ": more than 4294967295 elements");
  }
  if (layout.stride < layout.size) document.fail(layout.what + ": elements that overlap each other");
  if (accessor.bufferView >= 0) layout.bytes(document);
  if (!accessor.sparse.isSparse) return accessor.count;
  if (are_indices) document.fail(layout.what + ": sparse indices of vertices are not supported");
  if (!is_index_type(accessor.sparse.indices.componentType)) {
    document.fail(layout.what + ": its sparse indices are no unsigned integers");
  }
  if (accessor.sparse.count < 0 || static_cast<std::size_t>(accessor.sparse.count) > accessor.count) {
    document.fail(layout.what + ": more sparse elements than elements");
  }
  layout.sparse_indices(document);
  layout.sparse_values(document);
  return accessor.count;
}

GltfElements elements_of(const GltfDocument& document, int index) {
  const Layout layout(document, index, name_of(index));
  const tinygltf::Accessor& accessor = layout.accessor;
  GltfElements result;
  result.count = accessor.count;
  if (accessor.bufferView >= 0 && !accessor.sparse.isSparse) {
    result.bytes = layout.bytes(document);
    result.stride = layout.stride;
    result.component_type = accessor.componentType;
    result.normalized = accessor.normalized;
    return result;
  }
  const std::size_t components = components_of(accessor.type);
  result.own.reserve(components * accessor.count);
  if (accessor.bufferView >= 0) append(layout.bytes(document), accessor.count, layout.stride, accessor, result.own);
  result.own.resize(components * accessor.count, 0.0f);
  if (accessor.sparse.isSparse) {
    const GltfElements indices = layout.sparse_indices(document);
    std::vector<float> values;
    append(layout.sparse_values(document), indices.count, layout.size, accessor, values);
    with_indices(indices, [&](const auto& at) {
      for (std::size_t i = 0; i < indices.count; ++i) {
        const std::size_t target = at(i);
        if (target >= accessor.count) {
          document.fail(layout.what + ": sparse index " + std::to_string(target) + ", expected below " +
                        std::to_string(accessor.count));
        }
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * components), components,
                    result.own.begin() + static_cast<std::ptrdiff_t>(target * components));
      }
    });
  }
  result.stride = components * sizeof(float);
  result.bytes = {reinterpret_cast<const char*>(result.own.data()), result.own.size() * sizeof(float)};
  return result;
}

}  // namespace raylab
