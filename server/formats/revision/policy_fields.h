// The policy that a robot is judged by, in documents (docs/api.md, policy).
#pragma once

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/approval/policy_version.h"

namespace rigcal::formats {

// Versions and what is said, in metres, radians and nanoseconds; without the watermark, which is of all robots.
void WritePolicyMembers(JsonWriter& out, const PolicyInForce& in_force);
// A limit of 0 or less is as if nobody had said it.
[[nodiscard]] PolicyInForce ReadPolicyMembers(const JsonField& field);

}  // namespace rigcal::formats
