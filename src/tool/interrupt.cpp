// SPDX-License-Identifier: MIT
#include "tool/interrupt.h"

#include <atomic>
#include <csignal>

namespace relume {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> interrupt_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void raise_flag(int) {
  interrupt_flag = true;
}

}  // namespace

void watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = raise_flag;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return interrupt_flag;
}

Result<void> check_interrupted() {
  if (interrupted()) return fail(ErrorCode::cancelled, "Stopped as asked; nothing was written.");
  return {};
}

}  // namespace relume
