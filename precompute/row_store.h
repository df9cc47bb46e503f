// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/row_encoder.h"
#include "precompute/chunk_memory.h"
#include "precompute/row_tracer.h"

namespace relume {

/// Which rows of a system are encoded as they are traced, and how: a fraction of the memory.
struct StoreChoice {
  std::optional<ValueCodec> clusters, elements;
};

/// Appends the mean directions of form factors, given as moments (core/packed_direction.h); none without.
void pack_directions(std::span<const float> values, std::span<const glm::vec3> moments,
                     std::vector<std::uint32_t>& codes);

/// Rows as they will be stored, but that their columns are senders: there may be at most kMaxImports of
/// these. One per thread.
class RowStore {
 public:
  explicit RowStore(std::size_t senders) : seen_(senders, 0) {}

  /// Lives as long as the store.
  StoredRow put(const FormFactorRow& row, ValueCodec codec);
  /// Per sender: whether a row sees it.
  const std::vector<std::uint8_t>& seen() const { return seen_; }

 private:
  template <class T>
  std::span<const T> keep(std::span<const T> values);

  std::vector<std::uint8_t> seen_;
  ChunkMemory memory_;
  std::vector<std::uint16_t> columns_;  // their memory serves again
  std::vector<std::uint32_t> directions_;
  RowEncoder encoder_;
};

}  // namespace relume
