// Rows that answers and events share.
#pragma once

#include "server/formats/answers/answers.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::formats {

// Members of an object that is open: a session's row, as in the verbs sessions and session.
void WriteSessionMembers(JsonWriter& out, const SessionAnswer& session);
// `name`: null where it is absent.
void WriteStanding(JsonWriter& out, const std::string& name, const std::optional<Standing>& standing);
// "retired_sensors".
void WriteRetiredSensors(JsonWriter& out, const std::vector<RetiredSensor>& retired);
// Members of an edge's row; `residual` null: the solution has none.
void WriteEdgeRowMembers(JsonWriter& out, const Edge& edge, const EdgeResidual* residual);
// `usable`
void WriteUsable(JsonWriter& out, const std::optional<UsableRevision>& usable);
// "state", "decision", "in_use"; "cause" of one that was re-computed.
void WriteApproval(JsonWriter& out, const Approval& approval);
// "runs"
void WriteRuns(JsonWriter& out, const std::optional<Runs>& runs);
// Without its document.
void WriteRevisionMembers(JsonWriter& out, const Revision& revision);

}  // namespace rigcal::formats
