// SPDX-License-Identifier: MIT
#include "tool/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <ctime>
#include <string_view>

namespace relume {

const char* const kStoppedSentence = "Stopped as asked; nothing was written.";

namespace {

constexpr long kPatienceNanoseconds = 30'000'000;

// A signal handler can reach nothing but globals.
std::atomic<bool> interrupt_flag{false};
enum class Cut { forbidden, allowed, under_way };
std::atomic<Cut> cut{Cut::forbidden};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<Cut>::is_always_lock_free);
LastWords last_words;
timer_t patience;

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void raise_flag(int) {
  interrupt_flag = true;
  const itimerspec once{{0, 0}, {0, kPatienceNanoseconds}};
  timer_settime(patience, 0, &once, nullptr);
}

/// Only functions that a signal handler may call.
void cut_off(int) {
  Cut expected = Cut::allowed;
  if (!cut.compare_exchange_strong(expected, Cut::under_way)) return;
  write_all(STDERR_FILENO, last_words.err);
  write_all(STDOUT_FILENO, last_words.out);
  _exit(last_words.status);
}

void handle(int number, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigaction(number, &action, nullptr);
}

}  // namespace

void watch_interrupts(LastWords words) {
  last_words = std::move(words);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  if (timer_create(CLOCK_MONOTONIC, &event, &patience) == 0) cut = Cut::allowed;
  handle(SIGALRM, cut_off, SA_RESTART);
  handle(SIGINT, raise_flag, static_cast<int>(SA_RESETHAND));
  handle(SIGTERM, raise_flag, static_cast<int>(SA_RESETHAND));
}

void let_finish() {
  Cut expected = Cut::allowed;
  cut.compare_exchange_strong(expected, Cut::forbidden);
  while (expected == Cut::under_way) pause();  // another thread is about to end the program
}

void allow_cut() {
  Cut expected = Cut::forbidden;
  cut.compare_exchange_strong(expected, Cut::allowed);
}

bool interrupted() {
  return interrupt_flag;
}

Result<void> check_interrupted() {
  if (interrupted()) return fail(ErrorCode::cancelled, kStoppedSentence);
  return {};
}

}  // namespace relume
