// What counts and what was taken out, for people: of sessions, edges and sensors.
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include "client/text/document.h"

namespace rigcal::client {

// `session`: a row of docs/api.md, sessions.
[[nodiscard]] bool IsSuperseded(const Document& session);
[[nodiscard]] bool IsRetired(const Document& session);
// "Session A does not count: session B supersedes it ..." or "Session A is current ..."; how to take it back.
[[nodiscard]] std::string StandingText(const Document& session);
// The same, unless the session is not retired and neither supersedes nor is superseded.
void SayStanding(const Document& session, std::ostream& out);

// Of what `restore` or `retire` answered (docs/api.md): how the session, edge or sensor stands now.
void PrintStanding(const Document& done, std::ostream& out);

// `gone`: an element of `retired_sensors`. "front_left was retired on 2026-01-31 by Ada: taken off. `rigcal restore
// ...` brings it back."
[[nodiscard]] std::string RetiredSensorText(const std::string& robot, const Document& gone);
// Of each sensor in the list that `concerns` names: what is said of it does not count.
void SayRetiredSensors(const std::string& robot, const Document& retired_sensors,
                       const std::function<bool(const std::string& sensor)>& concerns, std::ostream& out);

}  // namespace rigcal::client
