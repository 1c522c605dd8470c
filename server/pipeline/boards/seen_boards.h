// Which of the boards that a session lists its sensors saw.
#pragma once

#include <map>
#include <vector>

#include "server/model/boards/remark.h"
#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// kNotKnown: a picture in which nobody could look for it, or a lidar beside a tracker, which sees plates and not which
// board they carry.
enum class BoardSeen { kYes, kNotKnown, kNo };

// READ, of what was found in the pictures so far: nothing is searched. Every target of the session is in it.
[[nodiscard]] Result<std::map<TargetId, BoardSeen>> LoadBoardsSeen(storage::Store& store, const Manifest& manifest);

// Leaves out what is said of boards that no sensor of the session saw: they are no reference of what was measured. That
// the registry has another pattern stays: it may be why nobody found that board.
void LeaveOutUnseen(const std::map<TargetId, BoardSeen>& seen, std::vector<BoardRemark>& remarks);
// The same of remarks on any sessions. READ.
[[nodiscard]] Status LeaveOutUnseen(storage::Store& store, std::vector<BoardRemark>& remarks);

}  // namespace rigcal::pipeline
