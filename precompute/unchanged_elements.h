// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "precompute/sender_lookup.h"
#include "precompute/surfaces.h"

namespace relume {

/// Per element (`keys`): which of the `old_keys` it was, if every ray that met that one meets it now, unless
/// something stands before it; else kNone. `settled`: per triangle, whether it is as it was. `disturbed(e,
/// reach)`: whether anything changed that near to an element. A hit on a lumel that walls run through or
/// beside goes to the element that it sees (SenderLookup), so nothing in the neighbourhood of an element near
/// such lumels may have changed.
std::vector<std::uint32_t> unchanged_elements(
    const Surfaces& surfaces, const SenderLookup& lookup, std::span<const std::uint64_t> keys,
    std::span<const std::uint64_t> old_keys, const std::vector<bool>& settled,
    const std::function<bool(std::uint32_t element, float reach)>& disturbed);

}  // namespace relume
