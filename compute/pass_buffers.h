// SPDX-License-Identifier: MIT
//
// Buffers of passes that are bound to a solver's: what they ask for, and whether they got it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compute/host_device.h"
#include "core/result.h"

namespace relume {

/// Every device aligns storage buffers to this or less.
inline constexpr VkDeviceSize kStorageAlignment = 256;

/// Every device binds ranges of this many bytes.
inline constexpr VkDeviceSize kMaxStorageBytes = VkDeviceSize{128} << 20;

/// A storage buffer that is filled by copies.
BufferRequirement storage_requirement(std::string name, VkDeviceSize byte_size);

/// Fails with no_device when one is larger than every device can bind.
Result<void> check_storage_sizes(std::span<const BufferRequirement> needed);

/// `ranges` cut to the sizes that are needed. Fails with usage when their number, sizes or alignment do not
/// fit.
Result<std::vector<BufferRange>> fit_ranges(std::span<const BufferRequirement> needed,
                                            std::span<const BufferRange> ranges);

/// Albedo and exitance, in this order, of so many clusters: four floats each, where a solver was bound to
/// them.
Result<std::vector<BufferRange>> fit_color_ranges(std::uint32_t clusters, const BufferRange& albedo,
                                                  const BufferRange& exitance);

template <class Element>
std::vector<std::byte> owned_bytes(const std::vector<Element>& elements) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(elements));
  return {bytes.begin(), bytes.end()};
}

}  // namespace relume
