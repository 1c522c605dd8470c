// Which captures of a session count as one, what they do, and how noisy its sensors are, in JSON.
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::formats {

// "groups" and "noise", only where there are any, as estimates of before have neither.
void WriteGroups(JsonWriter& out, const SessionEstimate& estimate);
void WriteNoise(JsonWriter& out, const SessionEstimate& estimate);
void ReadGroupsAndNoise(const JsonField& root, SessionEstimate& estimate);

}  // namespace rigcal::formats
