// SPDX-License-Identifier: MIT
//
// How far stored form factors can be from those that were encoded.
#pragma once

#include "core/block_matrix.h"

namespace relume {

/// With the pattern of decode(matrix): a bound on |stored - encoded| of each entry. Both sum to the same over
/// a row, so the differences of a row add up to zero but for a few units in the last place of f32. unorm16
/// rounds to half a code; sqrt8 takes one of the two codes around a value and carries the error of the sum
/// along, so that the sum is off by half of its largest step; both are then scaled to the row's sum.
CsrMatrix decode_slack(const BlockMatrix& matrix);

}  // namespace relume
