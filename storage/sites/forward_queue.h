// What the server of a site has still to send on to its centre. Filled in the transaction that makes a session or a
// batch of edges whole, and emptied once the centre confirmed it: whatever ends either server, nothing is left out, and
// what is sent twice is the same there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/robots/forward_state.h"
#include "storage/store.h"

namespace rigcal::storage {

struct WaitingForward {
  std::int64_t number = 0;  // of the queue: the oldest first
  bool is_batch = false;    // of finished edges; else a session
  std::string subject;      // the id of either
  RobotId robot;
  int attempts = 0;  // in vain
};

// Where the server sends what it stores, from now on; an empty address: nowhere. All whole sessions and batches that
// this centre has not confirmed wait, also those of before; for another one nothing waits any more. What was refused is
// tried again. A no-op otherwise where the address is that of before.
[[nodiscard]] Status SetCentre(Store& store, const std::string& url, Stamp now);

// The oldest that may be sent by `now`: what the centre refused waits for its time and holds up nothing else.
[[nodiscard]] Result<std::optional<WaitingForward>> LoadNextForward(Store& store, Stamp now);
// The centre has it on its disk. It waits no more; a no-op if it did not.
[[nodiscard]] Status MarkForwarded(Store& store, const WaitingForward& one, Stamp now);
// What this centre confirmed last of each robot, a few of each, the newest first; of many robots those of which it
// confirmed something last.
[[nodiscard]] Result<std::vector<WaitingForward>> LoadNewestForwarded(Store& store);
// All that is whole waits, also what this centre confirmed.
[[nodiscard]] Status ForwardAgain(Store& store);
// It was tried in vain, `error` says why, and is to be tried again then; {}: with its turn.
[[nodiscard]] Status NoteForwardFailure(Store& store, const WaitingForward& one, const std::string& error,
                                        Stamp next_try_at, Stamp now);

// Nothing where there is no centre.
[[nodiscard]] Result<std::optional<ForwardState>> LoadForwardState(Store& store);

}  // namespace rigcal::storage
