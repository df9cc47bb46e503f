// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/quantities.h"

namespace relume {

/// How far `values` are from `reference`, over all entries and channels. A relative error is |a - b| /
/// max(|b|, 1e-4 max|b|), b the reference, max over this output.
struct Comparison {
  std::string name;
  std::size_t count = 0;  ///< entries; errors are three times as many
  double max_relative_error = 0.0;
  double rms_relative_error = 0.0;
  double max_absolute_error = 0.0;
  std::size_t worst_index = 0;
  int worst_channel = 0;
  double worst_value = 0.0;
  double worst_reference = 0.0;
  std::array<std::size_t, 12> histogram{};  ///< errors in [10^-(k+1), 10^-k) at k = 0..10 (k = 0 also holds
                                            ///< larger ones), smaller in the last
};

/// Spans of equal length. With `magnitudes`, |b| in the relative error is instead of the reference the entry
/// of those: for sums of terms of both signs, which may be small where their terms are not. A value that is
/// not finite counts as an infinite error, and so does any light where all of the reference is dark.
Comparison compare(std::string name, std::span<const Rgb> values, std::span<const Rgb> reference,
                   std::span<const Rgb> magnitudes = {});

}  // namespace relume
