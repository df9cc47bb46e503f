// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>

#include "precompute/precompute.h"

namespace relume {

/// Tells the observer now and then how far a parallel loop is, and carries its wish to stop.
class Progress {
 public:
  Progress(const ProgressObserver& observer, const char* stage, std::size_t total)
      : observer_(observer), stage_(stage), total_(std::max<std::size_t>(total, 1)), step_(total / 256 + 1) {}
  bool cancelled() const { return cancelled_; }
  void one_done() {
    const std::size_t done = ++done_;
    if (!observer_ || done % step_ != 0) return;
    const std::lock_guard lock(mutex_);
    if (!cancelled_ && !observer_(stage_, double(done) / double(total_))) cancelled_ = true;
  }

 private:
  const ProgressObserver& observer_;
  const char* stage_;
  std::size_t total_, step_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
};

}  // namespace relume
