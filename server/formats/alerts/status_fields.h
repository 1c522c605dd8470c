// The status of robots and sensors in documents (docs/alerts.md, docs/api.md), and what a revision keeps of it.
#pragma once

#include <string>
#include <string_view>

#include "server/formats/json/json_writer.h"
#include "server/model/robots/robot_status.h"
#include "server/model/robots/robot_summary.h"

namespace rigcal::formats {

// "status": {"word", "why", "next_step"}.
void WriteCalibrationStatus(JsonWriter& out, const CalibrationStatus& status);
// "due": {"at", "by_age_at", "by_drift": {"at", "sensor", "law", "visits", "robots"} | null, "text"} | null.
void WriteDueMember(JsonWriter& out, const Validity& validity, const std::optional<DriftDue>& drift_due);
// Of a robot as of `now`: both of these, "site", "rig_model" and "operator", each null where it is not known, and
// "sensors" of one that has them.
void WriteStatusMembers(JsonWriter& out, const RobotSummary& robot, Stamp now);

// What a revision keeps; read back it is the same value.
[[nodiscard]] std::string WriteStatusFacts(const StatusFacts& facts);
// kInvalidInput names the field.
[[nodiscard]] Result<StatusFacts> ReadStatusFacts(std::string_view text);

}  // namespace rigcal::formats
