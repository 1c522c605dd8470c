// Ctrl-C, and what systemd sends, as a question that work asks now and then.
#pragma once

#include <csignal>

namespace rigcal::client {

// While it lives, SIGINT and SIGTERM end no process; there is one at a time.
class InterruptWatch {
 public:
  // From now on.
  InterruptWatch();
  // Signals do again what they did before.
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  // Whether one came.
  [[nodiscard]] static bool Came();

 private:
  struct sigaction interrupt_before_ = {}, terminate_before_ = {};
};

}  // namespace rigcal::client
