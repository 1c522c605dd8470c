// How far one camera's clock is from another's, of a board that both saw moving.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "client/moments/pose_track.h"

namespace rigcal::moments {

// For the same instant, `stamp of the sensor - stamp of the reference` is offset_s + drift_ratio (t - at_s), t on
// either clock. Sigmas by a jackknife over ten stretches of time, for what is left of neighbouring pictures is not
// independent.
struct ClockFit {
  double at_s = 0;  // since the beginning of both tracks
  double offset_s = 0, drift_ratio = 0;
  double offset_sigma_s = 0, drift_sigma_ratio = 0;

  // At t_s seconds since the beginning of both tracks.
  [[nodiscard]] double OffsetAt_s(double t_s) const { return offset_s + drift_ratio * (t_s - at_s); }
  [[nodiscard]] double SigmaAt_s(double t_s) const;
};

constexpr double kClockOff_sMax = 0.5;      // farther apart, motions are not searched for each other
constexpr double kDriftSigma_ratio = 1e-4;  // of crystals, known beforehand

// Speeds of the board's middle and of its turning, which all cameras of a rig see alike, are laid on each other; then
// the poses of the one, interpolated, on those of the other, with the pose between the cameras, offset and drift free
// (Huber's weights). `centre_board_m`: the board's middle. Nothing where there is too little motion, or the two do not
// tell the same one.
[[nodiscard]] std::optional<ClockFit> FitClock(const std::vector<TimedPose>& reference,
                                               const std::vector<TimedPose>& sensor,
                                               const Eigen::Vector3d& centre_board_m);

}  // namespace rigcal::moments
