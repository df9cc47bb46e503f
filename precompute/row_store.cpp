// SPDX-License-Identifier: MIT
#include "precompute/row_store.h"

#include <algorithm>
#include <cstring>

#include "core/packed_direction.h"

namespace relume {
namespace {

/// Bytes; with what an allocator adds, they fill a large page.
constexpr std::size_t kChunk = (std::size_t{2} << 20) - (std::size_t{64} << 10);

}  // namespace

void pack_directions(std::span<const float> values, std::span<const glm::vec3> moments,
                     std::vector<std::uint32_t>& codes) {
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const double value = values[i];
    codes.push_back(value > 0.0 ? pack_direction(glm::dvec3(moments[i]) / value) : 0u);
  }
}

StoredRow RowStore::put(const FormFactorRow& row, ValueCodec codec) {
  columns_.assign(row.senders.begin(), row.senders.end());
  for (const std::uint32_t sender : row.senders) seen_[sender] = 1;
  directions_.clear();
  pack_directions(row.values, row.moments, directions_);
  StoredRow stored = encoder_.encode(codec, columns_, std::span<const float>(row.values), directions_);
  stored.columns = keep(stored.columns);
  stored.values = keep(stored.values);
  stored.directions = keep(stored.directions);
  return stored;
}

template <class T>
std::span<const T> RowStore::keep(std::span<const T> values) {
  constexpr std::size_t kAlignment = alignof(std::uint32_t);
  if (values.empty()) return {};
  const std::size_t bytes = (values.size_bytes() + kAlignment - 1) / kAlignment * kAlignment;
  if (used_ + bytes > size_) {
    size_ = std::max(bytes, kChunk), used_ = 0;
    chunks_.push_back(std::make_unique_for_overwrite<std::byte[]>(size_));
  }
  std::byte* const at = chunks_.back().get() + used_;
  std::memcpy(at, values.data(), values.size_bytes());
  used_ += bytes;
  return {reinterpret_cast<const T*>(at), values.size()};
}

}  // namespace relume
