// Distances in metres that are more likely millimetres: too large for a robot, and yet possible numbers (plausible.h).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/sensors/pose_table.h"
#include "server/model/sessions/session.h"

namespace rigcal {

inline constexpr double kSensorsApartDoubted_m = 50.0;  // two sensors of one robot
inline constexpr double kSensorsApartMax_m = 100.0;     // no robot is that large
inline constexpr double kTrackerStepDoubted_m = 100.0;  // a tracked body, from one capture to the next

inline constexpr const char* kTakenInMetres = "Positions are taken in metres.";  // after a question

// Questions like "210 m between front_left and top: are these millimetres?", of the largest distance; where some look
// like millimetres and others like metres, "...: is top in millimetres, and left and rear in metres?". Empty where
// nothing is doubted. Sensors at p_m, all in one frame:
[[nodiscard]] std::string UnitDoubt(const std::map<std::string, Eigen::Vector3d>& p_m);
// The nominal poses of a session.
[[nodiscard]] std::string UnitDoubt(const SessionHeader& header);
// Each edge by itself.
[[nodiscard]] std::string UnitDoubt(const std::vector<Edge>& edges);
// The longest way from one row of a tracker to the next, in the order of their captures.
[[nodiscard]] double LongestStep_m(const PoseTable& tracker);
// The same rows, where they are doubted.
[[nodiscard]] std::string UnitDoubt(const PoseTable& tracker);

// Of a session all of these, by the file that each is about. `poses`: of its trackers; others are left out.
[[nodiscard]] std::map<std::string, std::string> UnitDoubts(const SessionHeader& header,
                                                            const std::map<SensorId, PoseTable>& poses);

// kInvalidInput, with the question, where nominal poses are more than kSensorsApartMax_m apart.
[[nodiscard]] Status CheckSensorsApart(const SessionHeader& header);

}  // namespace rigcal
