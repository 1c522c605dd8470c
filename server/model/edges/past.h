// Edges that a revision does not count any more, and why; sensors that were moved on purpose.
#pragma once

#include <string_view>

#include "server/model/edges/edge.h"
#include "server/model/sessions/session.h"

namespace rigcal {

// Codes of what takes an edge out of a revision: somebody retired it, or its session; one of its sensors was retired;
// its session was superseded by another of the same pictures, or its pair run again; or, of a good one, one of its
// sensors was remounted since, or another epoch of it began otherwise (epoch.h). Such an edge is failed in the
// revision, with this as its only diagnosis; the store keeps it as it was measured.
inline constexpr std::string_view kRetiredCode = "retired", kSensorRetiredCode = "sensor_retired",
                                  kSupersededCode = "superseded", kRemountedCode = "remounted", kEpochCode = "epoch";
// Whether a diagnosis has one of these codes; whether an edge has such a diagnosis and is failed.
[[nodiscard]] bool MeansPast(std::string_view diagnosis_code);
[[nodiscard]] bool IsPast(const Edge& edge);
// That it is of an earlier epoch of one of its sensors, whose pair is to be measured anew.
[[nodiscard]] bool IsOfEarlierEpoch(const Edge& edge);
// That nobody asks for its sensors on its account: it is retired, one of its sensors is gone from the robot, or another
// session of the same pictures has taken its place.
[[nodiscard]] bool AsksForNoSensor(const Edge& edge);

// Code of the only diagnosis of an edge that failed because the server's disk has not kept a file of its session. When
// that was sent again, the pair is run again: its edge then has the id RepeatedEdgeId (edge.h) of this one.
inline constexpr std::string_view kFileLostCode = "file_lost";
// Whether the edge waits for a file to be sent again.
[[nodiscard]] bool FailedForLostFile(const Edge& edge);

// Once, where it belongs among those that are named: in which order they are does not make another session.
void AddRemounted(SensorId sensor, SessionHeader& header);

}  // namespace rigcal
