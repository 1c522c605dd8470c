// What of a site's server is not at its centre yet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/stamp.h"

namespace rigcal {

struct ForwardState {
  std::string url;  // of the centre
  std::int64_t sessions_waiting = 0, batches_waiting = 0;
  std::int64_t refused = 0;                 // of them the centre did not take these: they are tried again later
  std::optional<Stamp> oldest_at = {};      // since when the oldest waits
  std::optional<Stamp> failing_since = {};  // since when nothing can be sent; absent: it can, as far as is known
  std::string last_error = {};              // why not, else why one was refused; empty: none was
};

}  // namespace rigcal
