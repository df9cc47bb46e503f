// SPDX-License-Identifier: MIT
#include "precompute/row_store.h"

#include <cstring>

#include "core/packed_direction.h"

namespace relume {

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
  if (values.empty()) return {};
  std::byte* const at = memory_.take(values.size_bytes()).data();
  std::memcpy(at, values.data(), values.size_bytes());
  return {reinterpret_cast<const T*>(at), values.size()};
}

}  // namespace relume
