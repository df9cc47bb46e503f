// SPDX-License-Identifier: MIT
#include "core/halvings.h"

#include "core/value_codec.h"

namespace relume {
namespace {

/// Appends the halvings of leaves [first, last), which get `all`.
void append_part(std::uint32_t first, std::uint32_t last, double all, const LeafSum& sum, HalvingList& list) {
  if (last - first == 1 || all <= 0.0) return;
  const std::uint32_t middle = first + (last - first) / 2;
  const double a = sum(first, middle), b = sum(middle, last);
  list.push_back(b <= 0.0   ? Halving::first
                 : a <= 0.0 ? Halving::second
                 : a <= b   ? Halving::second_least
                            : Halving::first_more);
  append_part(first, middle, a, sum, list);
  append_part(middle, last, b, sum, list);
}

/// Moves on behind the halvings of a node; false where they end before.
bool skip(std::span<const std::uint8_t> bytes, std::uint32_t count, std::uint64_t& next) {
  while (count > 1) {
    if (next >= 4 * bytes.size()) return false;
    const Halving halving = halving_at(bytes, next++);
    const std::uint32_t half = count / 2;
    const bool both = halving == Halving::second_least || halving == Halving::first_more;
    if (both && !skip(bytes, half, next)) return false;
    count = halving == Halving::first ? half : count - half;
  }
  return true;
}

}  // namespace

void HalvingList::push_back(Halving halving) {
  if (size_ % 4 == 0) bytes_.push_back(0);
  bytes_.back() =
      static_cast<std::uint8_t>(bytes_.back() | (static_cast<unsigned>(halving) << (2 * (size_ % 4))));
  ++size_;
}

void HalvingList::append(const HalvingList& list) {
  for (std::uint64_t i = 0; i < list.size(); ++i) push_back(halving_at(list.bytes(), i));
}

void append_halvings(std::uint32_t leaves, const LeafSum& sum, HalvingList& list) {
  if (leaves > 1) append_part(0, leaves, sum(0, leaves), sum, list);
}

std::vector<std::uint32_t> leaves_of_columns(const Model& model, const System& system) {
  std::vector<std::uint32_t> leaves;
  for (const SenderRef& sender : system.imports) {
    const bool sky = sender.system == kSkySystem;
    if (sender.system == kSpanningNodes) {
      leaves.push_back(0);
      continue;
    }
    const std::size_t own = sky ? model.sky_cells.size() : model.systems[sender.system].clusters.size();
    const ClusterTreeNodes& tree = sky ? model.sky_tree : model.systems[sender.system].tree;
    leaves.push_back(sender.index < own ? 1 : tree.nodes[sender.index - own].count);
  }
  return leaves;
}

std::optional<std::vector<std::uint64_t>> halving_offsets(const BlockMatrix& matrix,
                                                          std::span<const std::uint32_t> leaves,
                                                          std::span<const std::uint8_t> bytes) {
  std::vector<std::uint64_t> offsets{0};
  std::uint64_t next = 0;
  bool fits = true;
  for (const MatrixBlock& block : matrix.blocks) {
    for (std::uint32_t row = 0; row < block.row_count && fits; ++row) {
      visit_unscaled(block, row,
                     [&](std::uint32_t column, double) { fits = fits && skip(bytes, leaves[column], next); });
      offsets.push_back(next);
    }
  }
  if (!fits || (next + 3) / 4 != bytes.size()) return std::nullopt;
  for (std::uint64_t unused = next; unused < 4 * bytes.size(); ++unused) {
    if (halving_at(bytes, unused) != Halving::first) return std::nullopt;
  }
  return offsets;
}

}  // namespace relume
