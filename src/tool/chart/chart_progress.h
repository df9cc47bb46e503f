// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
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
    show_further(done_);
    return check_interrupted();
  }

  /// For a precompute of so many seconds; did() comes after it.
  ProgressObserver within(double seconds) {
    return [this, seconds](std::string_view stage, double fraction) {
      if (stage == "rays" || stage == "sensors") show_further(done_ + seconds * fraction);
      return !interrupted();
    };
  }

 private:
  /// A stage that begins again does not turn the clock back.
  void show_further(double seconds) {
    furthest_ = std::max(furthest_, seconds);
    show_(furthest_ / total_);
  }

  std::function<void(double)> show_;
  double total_, done_ = 0.0, furthest_ = 0.0;
};

}  // namespace relume
