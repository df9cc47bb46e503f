// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>

namespace relume {

/// Threads of an arena for `threads` as a user asks for them: 0 is all, and no more than the machine has (TBB
/// would ignore the rest, and say so on standard error).
inline int arena_threads(std::uint32_t threads) {
  if (threads == 0) return tbb::task_arena::automatic;
  return static_cast<int>(std::min<std::uint32_t>(threads, std::uint32_t(tbb::info::default_concurrency())));
}

}  // namespace relume
