// The poses of a revision with their joint covariance: all that the relative pose of any two of its sensors needs.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"
#include "server/model/sessions/session.h"

namespace rigcal {

// Of poses in the reference: six rows and columns per sensor, in this order; right tangents, m and rad. The reference
// has none: its pose is exact.
struct JointCovariance {
  std::vector<SensorId> sensors;
  Eigen::MatrixXd matrix;
};

struct JointPoses {
  SensorId reference;
  std::map<SensorId, Se3> T_ref_sensor;      // of all that are known, the reference too
  std::vector<JointCovariance> covariances;  // of two sensors the first that has both holds
};

// Where the graph of pairs put the sensors of a revision, also those of which only part of the pose is known: what the
// relative pose of two of them needs where one is not known whole. Right tangents, m and rad.
struct PlacedPoses {
  SensorId reference;
  std::vector<SensorId> sensors;      // that have a place, but for the reference
  std::vector<Se3> T_ref_sensor;      // of each; along what is open held
  Eigen::MatrixXd covariance;         // joint, six rows and columns per sensor; what is open is held
  Eigen::MatrixXd motions;            // six rows per sensor: what each free motion of the whole, a column, moves it by
  Vector6d scale = Vector6d::Ones();  // by which metres and radians were compared
  double visible = 0.0;               // what of a motion, scaled, is more than noise
};

// Of some pairs, how well two sensors are known to each other: of T_a_b, right tangent at b, m and rad.
using PairCovariances = std::map<SensorPair, Matrix6d>;

// More sensors than this make a matrix of megabytes.
constexpr std::size_t kJointPosesMax = 100;

}  // namespace rigcal
