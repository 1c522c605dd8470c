// What one joint refinement of a session's raw observations says of the robot during that visit.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"
#include "server/model/camera.h"
#include "server/model/diagnosis.h"

namespace rigcal {

// A sensor that had two poses during the session.
struct SensorMovedWithin {
  SensorId sensor;
  CaptureId last_before, first_after;
  Vector6d step = Vector6d::Zero();  // T_after = T_before Exp(step), right tangent at the sensor, m and rad
  double odds = 1.0;                 // of so large a change anywhere in the session by chance, at most
};

// One sensor's look in one capture that contradicts all others and was held back.
struct HeldBackLook {
  SensorId sensor;
  CaptureId capture;
};

// A camera whose pictures are bent in a way that its model cannot describe: a smooth field of shifts, the same in every
// capture, beyond what chance makes.
struct LensMisfit {
  SensorId camera;
  CameraModel model = CameraModel::kPinholeRadtan;
  double rms_px = 0.0;          // of the field where the camera saw corners, of u and of v
  double evidence = 0.0;        // twice the log of the likelihood's ratio with and without it
  double pose_sigma_m = 0.0;    // the most that it adds to the sigma of an axis of any pose, the square root of the
  double pose_sigma_rad = 0.0;  // variance
  double sigma_ratio = 1.0;     // of that pose and axis that it makes less certain most: with it over without any misfit
};

struct RefinedPose {
  SensorId sensor;
  Se3 T_ref_sensor;
  Matrix6d covariance = Matrix6d::Zero();  // marginal, right tangent at the sensor; zero for the reference
  double dof = 0.0;                        // behind it; 0: known
};

struct SessionEstimate {
  SessionId session;
  SensorId reference;
  std::vector<Diagnosis> why_not;  // not empty: there is no estimate, and nothing below has a meaning
  std::vector<RefinedPose> poses;  // sorted by sensor; the sensors that took part
  std::vector<SensorMovedWithin> moved;   // the most certain first
  std::vector<HeldBackLook> held_back;    // by sensor, then capture
  std::vector<LensMisfit> misfits;        // by camera; taken out of the poses as far as they are known
};

}  // namespace rigcal
