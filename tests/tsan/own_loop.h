// SPDX-License-Identifier: MIT
//
// In place of TBB where the thread sanitizer looks on. Debian's TBB is not built for it, so that the
// sanitizer does not see when a task begins after another and reports races that are none, in every loop.
// This has the same names for the few things that Relume uses, with std::thread, which the sanitizer knows:
// what it reports is a race. Loops inside loops run on the thread that meets them.
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {

namespace own {

inline constexpr int kThreads = 4;

inline bool& in_a_loop() {
  thread_local bool inside = false;
  return inside;
}

/// `run(i)` for i from 0 to `count`, each once; the first exception is thrown on.
template <class Run>
void loop(std::size_t count, const Run& run) {
  if (in_a_loop()) {
    for (std::size_t i = 0; i < count; ++i) run(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto work = [&] {
    in_a_loop() = true;
    try {
      for (std::size_t i = next++; i < count; i = next++) run(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      if (!thrown) thrown = std::current_exception();
    }
    in_a_loop() = false;
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 1; t < std::min<std::size_t>(kThreads, count); ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace own

template <class Index>
struct blocked_range {
  blocked_range(Index first, Index last, std::size_t size = 1) : from(first), to(last), grain(size) {}
  Index begin() const { return from; }
  Index end() const { return to; }
  Index from, to;
  std::size_t grain;
};

template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (first < last)
    own::loop(static_cast<std::size_t>(last - first),
              [&](std::size_t i) { body(static_cast<Index>(first + i)); });
}

template <class Index, class Body>
void parallel_for(const blocked_range<Index>& range, const Body& body) {
  const auto size = static_cast<std::size_t>(range.to - range.from);
  own::loop((size + range.grain - 1) / range.grain, [&](std::size_t i) {
    const Index from = static_cast<Index>(range.from + i * range.grain);
    body(blocked_range<Index>(from, std::min(range.to, static_cast<Index>(from + range.grain)), range.grain));
  });
}

template <class... Bodies>
void parallel_invoke(const Bodies&... bodies) {
  const std::vector<std::function<void()>> all{std::cref(bodies)...};
  own::loop(all.size(), [&](std::size_t i) { all[i](); });
}

template <class Value>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() : make_([] { return Value(); }) {}
  template <class Make>
  explicit enumerable_thread_specific(Make make) : make_(make) {}

  Value& local() {
    const std::lock_guard lock(mutex_);
    const auto owner = std::find(owners_.begin(), owners_.end(), std::this_thread::get_id());
    if (owner != owners_.end()) return values_[static_cast<std::size_t>(owner - owners_.begin())];
    owners_.push_back(std::this_thread::get_id());
    return values_.emplace_back(make_());
  }

  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  void clear() { owners_.clear(), values_.clear(); }

 private:
  std::function<Value()> make_;
  std::mutex mutex_;
  std::vector<std::thread::id> owners_;
  std::deque<Value> values_;  ///< in the order of owners_; stay where they are
};

struct task_arena {
  static constexpr int automatic = -1;
  explicit task_arena(int = automatic) {}
  template <class Run>
  auto execute(const Run& run) {
    return run();
  }
};

struct global_control {
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t) {}
};

namespace info {
inline int default_concurrency() {
  return own::kThreads;
}
}  // namespace info

}  // namespace tbb
