#include "client/programs/interrupt.h"

#include <atomic>

namespace rigcal::client {
namespace {

std::atomic<bool> signal_came{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

}  // namespace

InterruptWatch::InterruptWatch() {
  signal_came = false;
  struct sigaction action {};
  action.sa_handler = [](int) { signal_came = true; };
  sigaction(SIGINT, &action, &interrupt_before_);
  sigaction(SIGTERM, &action, &terminate_before_);
}

InterruptWatch::~InterruptWatch() {
  sigaction(SIGINT, &interrupt_before_, nullptr);
  sigaction(SIGTERM, &terminate_before_, nullptr);
}

bool InterruptWatch::Came() { return signal_came; }

}  // namespace rigcal::client
