#include "client/programs/interrupt.h"

#include <atomic>
#include <csignal>

namespace rigcal::client {
namespace {

std::atomic<bool> signal_came{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

}  // namespace

InterruptWatch::InterruptWatch() {
  signal_came = false;
  struct sigaction action {};
  action.sa_handler = [](int) { signal_came = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

InterruptWatch::~InterruptWatch() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptWatch::Came() { return signal_came; }

}  // namespace rigcal::client
