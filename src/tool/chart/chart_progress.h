// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <utility>

#include "precompute/precompute.h"
#include "tool/interrupt.h"

namespace relume {

/// How far the whole measurement is. Work is counted in seconds, as guessed for two quiet cores.
class ChartProgress {
 public:
  ChartProgress(std::function<void(double fraction)> show, double total)
      : show_(std::move(show)), total_(total) {}

  /// Fails with `cancelled` when interrupted.
  Result<void> did(double seconds) {
    done_ += seconds;
    show_(done_ / total_);
    return check_interrupted();
  }

  /// For a precompute of so many seconds; did() comes after it.
  ProgressObserver within(double seconds) {
    return [this, seconds](std::string_view stage, double fraction) {
      if (stage == "rays") show_((done_ + seconds * fraction) / total_);
      return !interrupted();
    };
  }

 private:
  std::function<void(double)> show_;
  double total_, done_ = 0.0;
};

}  // namespace relume
