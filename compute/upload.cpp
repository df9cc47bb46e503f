// SPDX-License-Identifier: MIT
#include "compute/upload.h"

#include <iterator>
#include <utility>

namespace relume {

void UploadData::add_owned(const BufferRange& target, VkDeviceSize offset, std::vector<std::byte> bytes) {
  owned.push_back(std::move(bytes));
  pieces.push_back({target.buffer, target.offset + offset, owned.back()});
}

void UploadData::append(UploadData other) {
  // Moving a vector keeps its elements where they are, so pieces go on pointing at them.
  std::move(other.owned.begin(), other.owned.end(), std::back_inserter(owned));
  pieces.insert(pieces.end(), other.pieces.begin(), other.pieces.end());
}

}  // namespace relume
