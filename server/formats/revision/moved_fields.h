// What moved during a session, in JSON: members of a row of its estimate (docs/api.md).
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::formats {

void WriteMoved(JsonWriter& out, const SensorMovedWithin& moved);
[[nodiscard]] SensorMovedWithin ReadMoved(const JsonField& field);
// "board", or "world_of" where it is the world of a tracker.
void WriteBoardMoved(JsonWriter& out, const BoardMovedWithin& moved);
[[nodiscard]] BoardMovedWithin ReadBoardMoved(const JsonField& field);

}  // namespace rigcal::formats
