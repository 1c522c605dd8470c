// Edges of a rig file: what a drawing or another tool says, with the uncertainty that a person states for it.
#pragma once

#include <vector>

#include "server/formats/rig_files/frames.h"
#include "server/model/edges/edge.h"

namespace rigcal::rig_files {

// A sensor, and the frame of the file that is its.
struct SensorFrame {
  SensorId sensor;
  std::string frame;
};
// 1 sigma of each axis of a sensor, m and rad.
struct AssumedSigma {
  double m = 0.0, rad = 0.0;
};
// "5,0.5": MM,DEG; both positive. kInvalidInput says how it is written.
[[nodiscard]] Result<AssumedSigma> ParseAssumedSigma(const std::string& text);
// "left" or "left=camera0": kInvalidInput of what is no sensor's name, or has an empty frame.
[[nodiscard]] Result<SensorFrame> ParseSensorFrame(const std::string& text);

// All frames of the file as sensors of their own names; kInvalidInput of a URDF (most of its links are none), and of
// names that no sensor may have: the cure is to name sensors.
[[nodiscard]] Result<std::vector<SensorFrame>> AllFrames(const RigFile& file);

// An edge from the first sensor to each other one: T_a_b, independent axes, method `assumed`, source assumed, dof 0;
// ids are assigned. kNotFound names a frame that no fixed joints tie to the first one; kInvalidInput of fewer than two
// sensors.
[[nodiscard]] Result<std::vector<Edge>> AssumedEdges(const RigFile& file, const RobotId& robot,
                                                     const std::vector<SensorFrame>& sensors,
                                                     const AssumedSigma& sigma);

}  // namespace rigcal::rig_files
