// SPDX-License-Identifier: MIT
//
// How a row's form factor to a node is shared out among the leaves of the node, in a few bits. The leaves are
// halved again and again, n of them into the first n / 2 (rounded down) and the rest, until one is left. Of
// each part that gets any of the form factor, two bits say what its halves get; a part that gets nothing has
// no bits. So bounds on a solution (bracket.h) need not assume that the brightest leaf of a node, or the
// darkest, gets all.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/model.h"

namespace relume {

/// Where the form factor to a part of a node goes.
enum class Halving : std::uint8_t {
  first = 0,         ///< all to the first half
  second = 1,        ///< all to the second
  second_least = 2,  ///< to both; at least as much to the second
  first_more = 3     ///< to both; more to the first
};

/// Four to a byte, lowest bits first; zeros after the last.
class HalvingList {
 public:
  void push_back(Halving halving);
  void append(const HalvingList& list);
  std::uint64_t size() const { return size_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t size_ = 0;
};

inline Halving halving_at(std::span<const std::uint8_t> bytes, std::uint64_t index) {
  return static_cast<Halving>((bytes[index / 4] >> (2 * (index % 4))) & 3u);
}

/// What leaves [first, last) of a node get together; sums of numbers that are not negative.
using LeafSum = std::function<double(std::uint32_t first, std::uint32_t last)>;

/// Appends the halvings of a node of so many leaves, parts before their halves and the first half first.
/// Nothing where the leaves get nothing.
void append_halvings(std::uint32_t leaves, const LeafSum& sum, HalvingList& list);

/// What leaves get at most for 1 that their node gets, leaf i being worth value(i): for each part, the better
/// of what its halving allows. `next`: the first halving of the node; moves on behind its last.
template <class Value, class LeafValue>
Value most_of_halves(std::span<const std::uint8_t> bytes, std::uint32_t first, std::uint32_t count,
                     std::uint64_t& next, const LeafValue& value) {
  using std::max;
  if (count == 1) return value(first);
  const Halving halving = halving_at(bytes, next++);
  const std::uint32_t half = count / 2;
  if (halving == Halving::first) return most_of_halves<Value>(bytes, first, half, next, value);
  if (halving == Halving::second)
    return most_of_halves<Value>(bytes, first + half, count - half, next, value);
  const Value a = most_of_halves<Value>(bytes, first, half, next, value);
  const Value b = most_of_halves<Value>(bytes, first + half, count - half, next, value);
  return max(halving == Halving::first_more ? a : b, 0.5 * (a + b));
}

/// Per column of a system: leaves of the node that it means, 1 of a leaf, 0 of a node above the systems, of
/// which nothing is told. All systems must be loaded.
std::vector<std::uint32_t> leaves_of_columns(const Model& model, const System& system);

/// Halvings of a matrix stand row after row and, inside a row, in the order of its columns: of each stored
/// value that is not zero and whose column means `leaves[column]` > 1 leaves. Number of the first of each
/// row, and of all at the end; nothing when the bytes do not fit the matrix or the bits after the last are
/// not zero.
std::optional<std::vector<std::uint64_t>> halving_offsets(const BlockMatrix& matrix,
                                                          std::span<const std::uint32_t> leaves,
                                                          std::span<const std::uint8_t> bytes);

}  // namespace relume
