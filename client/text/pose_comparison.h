// Poses of a rig's sensors from two sources, side by side.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/text/document.h"
#include "server/base/result.h"
#include "server/math/se3.h"

namespace rigcal::client {

struct KnownPose {
  Se3 T_ref_sensor;
  std::optional<Vector6d> sigma;  // one standard deviation per axis of the sensor; absent: not known
};
using KnownPoses = std::map<std::string, KnownPose>;

// The sensors that a revision's document ("document" of `show`) knows.
[[nodiscard]] KnownPoses PosesOfRevision(const Document& revision);
// Of a YAML file with `sensors: {NAME: {T_ref_sensor: {p_m, q_xyzw}}}`; T_ref_nominal does as well, so that a
// session.yaml gives the poses of the drawing. Sensors without a pose are left out. Other keys do not matter.
[[nodiscard]] Result<KnownPoses> PosesOfFile(const std::string& path);

struct PoseDifference {
  std::string sensor;
  Vector6d e = Vector6d::Zero();  // Log(T_other^-1 T), along and about the sensor's axes; m, rad
  std::optional<Vector6d> sigma;  // of T, or of T_other where that is known and larger
  // The largest |e_i| / sigma_i; absent without sigma.
  [[nodiscard]] std::optional<double> WorstSigmas() const;
};

// Every sensor that both have, `others` moved rigidly so that the reference's poses coincide; without the reference
// itself. kNotFound if one of them does not have the reference, or they share no other sensor.
[[nodiscard]] Result<std::vector<PoseDifference>> ComparePoses(const KnownPoses& poses, const KnownPoses& others,
                                                               const std::string& reference);

}  // namespace rigcal::client
