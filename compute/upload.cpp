// SPDX-License-Identifier: MIT
#include "compute/upload.h"

#include <iterator>
#include <utility>

namespace relume {

void UploadData::add_owned(std::uint32_t buffer, VkDeviceSize offset, std::vector<std::byte> bytes) {
  owned.push_back(std::move(bytes));
  pieces.push_back({buffer, offset, owned.back()});
}

void UploadData::append(UploadData other) {
  const auto first = static_cast<std::uint32_t>(targets.size());
  targets.insert(targets.end(), other.targets.begin(), other.targets.end());
  // Moving a vector keeps its elements where they are, so pieces go on pointing at them.
  std::move(other.owned.begin(), other.owned.end(), std::back_inserter(owned));
  for (UploadPiece piece : other.pieces) {
    piece.buffer += first;
    pieces.push_back(piece);
  }
}

}  // namespace relume
