// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "precompute/sender_lookup.h"
#include "precompute/surfaces.h"

namespace relume {

/// Of `old_of`, per element which of an earlier scene has its key, or kNone: those that every ray still meets
/// that met them, unless something stands before them; the others are kNone. `settled`: per triangle, whether
/// it is as it was. `disturbed(e, reach)`: whether anything changed that near to an element. A hit on a lumel
/// that walls run through or beside goes to the element that it sees (SenderLookup), so nothing in the
/// neighbourhood of an element near such lumels may have changed.
std::vector<std::uint32_t> unchanged_elements(
    const Surfaces& surfaces, const SenderLookup& lookup, const std::vector<std::uint32_t>& old_of,
    const std::vector<bool>& settled,
    const std::function<bool(std::uint32_t element, float reach)>& disturbed);

}  // namespace relume
