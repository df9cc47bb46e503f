// SPDX-License-Identifier: MIT
#include "scene/import/accessor_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "scene/import/import_error.h"

namespace relume {
namespace {

/// An accessor without a view is all zeros and costs nothing in the file; no mesh worth drawing has more of
/// them.
constexpr std::uint64_t kMaxZeros = 1u << 20;

/// Elements of one accessor, or of one half of its sparse part.
struct Elements {
  std::span<const std::byte> bytes;
  std::size_t offset = 0;
  std::size_t stride = 0;
  int component_type = 0;
  int components = 1;
  bool normalised = false;

  std::size_t component_bytes() const {
    return static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type)));
  }
};

template <class T>
T load(const Elements& elements, std::uint64_t index, int component) {
  T value;
  const std::size_t at =
      elements.offset + index * elements.stride + static_cast<std::size_t>(component) * sizeof(T);
  std::memcpy(&value, elements.bytes.data() + at, sizeof(T));
  return value;
}

/// glTF 2.0, 3.11: signed normalised integers stop at -1.
template <class T>
double load_scaled(const Elements& elements, std::uint64_t index, int component) {
  const double value = static_cast<double>(load<T>(elements, index, component));
  return elements.normalised ? std::max(value / std::numeric_limits<T>::max(), -1.0) : value;
}

double load_number(const Elements& elements, std::uint64_t index, int component) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load_scaled<std::int8_t>(elements, index, component);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load_scaled<std::uint8_t>(elements, index, component);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load_scaled<std::int16_t>(elements, index, component);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load_scaled<std::uint16_t>(elements, index, component);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<double>(load<std::uint32_t>(elements, index, component));
    default:
      return static_cast<double>(load<float>(elements, index, component));
  }
}

std::uint32_t load_index(const Elements& elements, std::uint64_t index) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(elements, index, 0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(elements, index, 0);
    default:
      return load<std::uint32_t>(elements, index, 0);
  }
}

Elements elements_of(const GltfFile& gltf, const tinygltf::Accessor& accessor, const AccessorUse& use) {
  Elements elements;
  elements.component_type = accessor.componentType;
  elements.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  elements.normalised = accessor.normalized || use.normalised_integers;
  elements.offset = accessor.byteOffset;
  elements.stride = elements.component_bytes() * static_cast<std::size_t>(elements.components);
  if (accessor.bufferView >= 0) {
    const auto view = static_cast<std::size_t>(accessor.bufferView);
    elements.bytes = gltf.data.views[view];
    if (gltf.model.bufferViews[view].byteStride != 0)
      elements.stride = gltf.model.bufferViews[view].byteStride;
  }
  return elements;
}

Result<void> check_use(const GltfFile& gltf, const tinygltf::Accessor& accessor, const AccessorUse& use) {
  if (std::find(use.types.begin(), use.types.end(), accessor.type) == use.types.end()) {
    return import_error(
        gltf.name, use.place,
        fmt::format("an accessor of {} components",
                    tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(use.types.front()))),
        fmt::format("one of {}",
                    tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type))));
  }
  const bool is_float = accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool is_wide = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if ((use.only_float && !is_float) || is_wide) {
    return import_error(
        gltf.name, use.place,
        use.only_float ? "an accessor of floats" : "an accessor of floats or 8- or 16-bit integers",
        fmt::format("component type {}", accessor.componentType));
  }
  if (accessor.bufferView < 0 && accessor.count > kMaxZeros) {
    return import_error(gltf.name, use.place,
                        fmt::format("an accessor with data, or at most {} zeros", kMaxZeros),
                        fmt::format("{} elements without a bufferView", accessor.count));
  }
  return {};
}

Result<void> apply_sparse(const GltfFile& gltf, const tinygltf::Accessor& accessor, const Elements& base,
                          const AccessorUse& use, AccessorValues& out) {
  Elements indices;
  indices.bytes = gltf.data.views[static_cast<std::size_t>(accessor.sparse.indices.bufferView)];
  indices.offset = static_cast<std::size_t>(accessor.sparse.indices.byteOffset);
  indices.component_type = accessor.sparse.indices.componentType;
  indices.stride = indices.component_bytes();
  Elements values = base;
  values.bytes = gltf.data.views[static_cast<std::size_t>(accessor.sparse.values.bufferView)];
  values.offset = static_cast<std::size_t>(accessor.sparse.values.byteOffset);
  values.stride = base.component_bytes() * static_cast<std::size_t>(base.components);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(accessor.sparse.count); ++i) {
    const std::uint64_t target = load_index(indices, i);
    if (target >= accessor.count) {
      return import_error(gltf.name, fmt::format("{}, sparse index {}", use.place, i),
                          fmt::format("an index below {}", accessor.count), fmt::format("{}", target));
    }
    for (int c = 0; c < base.components; ++c) {
      out.values[target * static_cast<std::uint64_t>(base.components) + static_cast<std::uint64_t>(c)] =
          load_number(values, i, c);
    }
  }
  return {};
}

Result<void> check_finite(const GltfFile& gltf, const AccessorUse& use, const AccessorValues& out) {
  const auto bad =
      std::find_if(out.values.begin(), out.values.end(), [](double v) { return !std::isfinite(v); });
  if (bad == out.values.end()) return {};
  const auto at = static_cast<std::uint64_t>(bad - out.values.begin());
  const auto components = static_cast<std::uint64_t>(out.components);
  return import_error(gltf.name, fmt::format("{}, element {}", use.place, at / components), "finite numbers",
                      fmt::format("{} as component {}", *bad, at % components));
}

}  // namespace

Result<AccessorValues> read_accessor(const GltfFile& gltf, int index, const AccessorUse& use) {
  const auto& accessor = gltf.model.accessors[static_cast<std::size_t>(index)];
  if (auto result = check_use(gltf, accessor, use); !result) return tl::unexpected(result.error());
  const Elements elements = elements_of(gltf, accessor, use);
  AccessorValues out{accessor.count, elements.components, {}};
  out.values.resize(accessor.count * static_cast<std::size_t>(elements.components));
  if (accessor.bufferView >= 0) {
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < out.count; ++i) {
      for (int c = 0; c < elements.components; ++c) out.values[at++] = load_number(elements, i, c);
    }
  }
  if (accessor.sparse.isSparse) {
    if (auto result = apply_sparse(gltf, accessor, elements, use, out); !result) {
      return tl::unexpected(result.error());
    }
  }
  if (auto result = check_finite(gltf, use, out); !result) return tl::unexpected(result.error());
  return out;
}

Result<std::vector<std::uint32_t>> read_indices(const GltfFile& gltf, int index, const std::string& place,
                                                std::uint64_t limit) {
  const auto& accessor = gltf.model.accessors[static_cast<std::size_t>(index)];
  const bool is_unsigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                           accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_unsigned) {
    return import_error(gltf.name, place, "a scalar accessor of unsigned integers", "another type");
  }
  if (accessor.bufferView < 0 || accessor.sparse.isSparse) {
    return import_error(gltf.name, place, "an accessor with a bufferView and no sparse part", "another one");
  }
  const Elements elements = elements_of(gltf, accessor, {});
  std::vector<std::uint32_t> out(accessor.count);
  for (std::uint64_t i = 0; i < accessor.count; ++i) {
    out[i] = load_index(elements, i);
    if (out[i] >= limit) {
      return import_error(gltf.name, fmt::format("{}, element {}", place, i),
                          fmt::format("an index below {}", limit), fmt::format("{}", out[i]));
    }
  }
  return out;
}

}  // namespace relume
