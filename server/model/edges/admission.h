// Whether a new session may enter. Apart from Validate: a session that was admitted stays valid when limits get
// stricter.
#pragma once

#include "server/base/limits_in_force.h"
#include "server/base/result.h"
#include "server/model/edges/edge.h"
#include "server/model/sessions/session.h"

namespace rigcal {

// `manifest` is valid. kInvalidInput names the limit that it breaks, and the file where there is one.
[[nodiscard]] Status CheckAdmission(const Manifest& manifest, const limits::Limits& limits);

// Age and due dates count from captured_at, so a session from the future would never be due. A day is allowed for
// clocks in other time zones. `now`: of whose clock, the error names.
[[nodiscard]] Status CheckCapturedAt(const SessionHeader& header, Stamp now, const std::string& whose = "this server");
// Likewise of a finished edge that says when it was measured.
[[nodiscard]] Status CheckMeasuredAt(const Edge& edge, Stamp now);

}  // namespace rigcal
