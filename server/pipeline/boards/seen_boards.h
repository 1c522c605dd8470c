// Which of the boards that a session lists its sensors saw.
#pragma once

#include <map>

#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// kNotKnown: a picture in which nobody could look for it, or a lidar beside a tracker, which sees plates and not which
// board they carry.
enum class BoardSeen { kYes, kNotKnown, kNo };

// READ, of what was found in the pictures so far: nothing is searched. Every target of the session is in it.
[[nodiscard]] Result<std::map<TargetId, BoardSeen>> LoadBoardsSeen(storage::Store& store, const Manifest& manifest);

}  // namespace rigcal::pipeline
