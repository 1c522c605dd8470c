// Asks the server for a calibration as a value: poses, covariances in the wanted frame, and intrinsics.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/verb.h"
#include "server/formats/export/calibration.h"

namespace rigcal::client {

struct CalibrationQuery {
  std::string robot;
  int revision = 0;                             // 0: the one that is in use
  std::optional<SensorId> root = {};            // absent: the revision's reference
  bool even_if_not_approved = false;            // then without one in use the newest
  bool may_be_overruled = true;                 // the verb has that option
  std::map<SensorId, std::string> frames = {};  // other names of frames in the file
};
struct AskedCalibration {
  exports::Calibration calibration;
  std::string doubt;   // a sentence that people should read beside it; empty: none
  std::string digest;  // of the revision's document; empty where an older server tells none
};

// Questions `show`, `sensors`, and of another root one `lookup` per sensor: its covariance in that root takes what the
// solution knows of both together. Errors: those of the server, of MayLeave, of exports::Rebased and RenameFrames.
[[nodiscard]] Result<AskedCalibration> AskCalibration(const Context& context, const CalibrationQuery& query);
// The same over a connection that is there; each question waits for `timeout` at most.
[[nodiscard]] Result<AskedCalibration> AskCalibration(Connection& connection, const CalibrationQuery& query,
                                                      std::chrono::milliseconds timeout);

// --frame SENSOR=FRAME, as often as it is given. kInvalidInput of a wrong one, and of a sensor that is named twice.
[[nodiscard]] Result<std::map<SensorId, std::string>> FramesOf(const std::vector<std::string>& options);

}  // namespace rigcal::client
