// poses.csv: the poses of a tracker's body, one per capture, or of a pose stream, one per stamp. Between the rows of
// its captures a tracker may have rows without a capture, its path: where the body was at other stamps of the same
// clock.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/sensors/pose_table.h"
#include "server/model/sessions/session.h"

namespace rigcal::formats {

// The first line of the file of a sensor of this kind (kTracker or kPoseStream).
[[nodiscard]] std::string_view PoseHeader(SensorKind kind);

// The header, then a row per line of numbers in plain decimal notation, separated by commas; blank lines and a "\r"
// before "\n" do not matter. Quaternions are of unit length within 1e-3 and normalised. A tracker's rows come in any
// order and go out sorted by capture, none twice, without its path; a stream's stamps increase strictly, and so do
// those of a path. At least one row (of a tracker: of a capture). Errors name `name` and the line.
[[nodiscard]] Result<PoseTable> ReadPoses(std::string_view text, SensorKind kind, const std::string& name);
// The same for a tracker of a session that has these captures: another one is refused too.
[[nodiscard]] Result<PoseTable> ReadPosesOf(const std::set<CaptureId>& captures, std::string_view text,
                                            const std::string& name);
// The rows of a tracker's file that have no capture, by stamp; empty where it has none. Refuses what ReadPoses refuses.
[[nodiscard]] Result<PoseTable> ReadTrackerPath(std::string_view text, const std::string& name);

}  // namespace rigcal::formats
