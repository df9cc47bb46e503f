// SPDX-License-Identifier: MIT
//
// How far stored form factors can be from those that were encoded.
#pragma once

#include "core/block_matrix.h"

namespace relume {

/// Differences between stored and encoded values. Those of a row add up to zero but for a few units in the
/// last place of f32: unorm16 rounds to half a code; sqrt8 takes one of the two codes around a value and
/// carries the error of the sum along, so that the sum up to any value is off by no more than half of the
/// largest step so far; both are then scaled to the row's sum.
struct ValueSlack {
  CsrMatrix each;  ///< with the pattern of decode(matrix): a bound on |stored - encoded|
  /// Per entry of it: a bound on the absolute sum of (code - encoded) of its row up to it, before codes are
  /// scaled to the row's sum. With any x and the mean m of x that the stored row makes,
  /// sum encoded x = sum stored x - sum (code - encoded) (x - m).
  std::vector<double> running;
};

ValueSlack decode_slack(const BlockMatrix& matrix);

}  // namespace relume
