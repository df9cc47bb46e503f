// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/import/gltf_file.h"

namespace relume {

/// What an accessor must be to serve as one thing.
struct AccessorUse {
  std::string place;                 ///< JSON path of the property that names the accessor
  std::vector<int> types;            ///< allowed TINYGLTF_TYPE_*
  bool only_float = false;           ///< else also (normalised or plain) 8- and 16-bit integers
  bool normalised_integers = false;  ///< integers count as normalised even when the accessor does not say so
};

/// An accessor's elements in double precision, sparse parts applied, every number checked to be finite.
struct AccessorValues {
  std::uint64_t count = 0;
  int components = 0;
  std::vector<double> values;  ///< count x components
};
Result<AccessorValues> read_accessor(const GltfFile& gltf, int accessor, const AccessorUse& use);

/// Unsigned integers of any width. `limit`: each must be below it.
Result<std::vector<std::uint32_t>> read_indices(const GltfFile& gltf, int accessor, const std::string& place,
                                                std::uint64_t limit);

}  // namespace relume
