// Numbers and lists as sentences show them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/approval/policy.h"
#include "server/model/edges/edge.h"
#include "server/model/verdict_basis.h"

namespace rigcal::fleet {

[[nodiscard]] std::string Number(double value, const char* unit);     // three digits and the unit
[[nodiscard]] std::string TwoDigits(double value, const char* unit);  // of what is itself an estimate, a sigma
[[nodiscard]] std::string PlainNumber(double value);                  // without a unit
// "a", "a and b", "a, b and c", "a, b, c, d, e, f and 3 more".
[[nodiscard]] std::string List(const std::vector<std::string>& names);
[[nodiscard]] std::string List(const std::vector<SensorId>& sensors);
// However many: what a robot must not be relied on for is no place to be short.
[[nodiscard]] std::string ListAll(const std::vector<SensorId>& sensors);
[[nodiscard]] std::string NameOfEdge(const Edge& edge);
// "30 mm and 0.2 deg": the lengths of both halves of a tangent vector.
[[nodiscard]] std::string OffText(const Vector6d& e);
// "30 mm, 0.2 deg": likewise, where the sentence goes on.
[[nodiscard]] std::string OffList(const Vector6d& e);
// "5 mm and 0.29 deg", of sigmas.
[[nodiscard]] std::string SigmaText(double sigma_m, double sigma_rad);
[[nodiscard]] std::string LimitText(const PoseLimit& limit);
// "20 mm", "limit 1 mm": of the half of `off` that is more times its limit.
[[nodiscard]] DecidingFigure OffFigure(std::string name, const Vector6d& off, const PoseLimit& limit);
// "28 mm", "limit 5 mm": likewise of sigmas.
[[nodiscard]] DecidingFigure SigmaFigure(std::string name, double sigma_m, double sigma_rad, const PoseLimit& limit);

// As people know a session: by its time ("2026-01-31 12:00 UTC"; where only the day was given, "2026-01-31"); where
// that is not known by its id, where it is the same of two by both.
[[nodiscard]] std::string NameOfSession(const SessionId& session, const std::map<SessionId, Stamp>& captured_at);

constexpr double kDegreesPerRadian = 57.29577951308232;

}  // namespace rigcal::fleet
