// SPDX-License-Identifier: MIT
#include "compute/upload.h"

#include <utility>

namespace relume {

void UploadData::add_owned(std::uint32_t buffer, VkDeviceSize offset, std::vector<std::byte> bytes) {
  owned.push_back(std::move(bytes));
  pieces.push_back({buffer, offset, owned.back()});
}

}  // namespace relume
