// A virtual rig before which somebody holds a board: what its cameras see of it, with the simulator's lenses and noise.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/companion/captured.h"
#include "client/sim/visit/observe.h"
#include "server/calib/joint/problem/session_start.h"

namespace rigcal {

// Cameras of 640 x 480 px on a ring, each turned by `turn_deg` from the one before, `apart_m` beside it; a board of 9 x
// 6 corners, 80 mm apart; corners with 0.2 px of noise.
[[nodiscard]] std::string RingYaml(int cameras, double turn_deg, double apart_m);

class HeldBoard {
 public:
  // `captures_max` captures at most. What is declared of the cameras is what a drawing and a calibration say: off by
  // the rig's nominal sigmas.
  [[nodiscard]] static Result<HeldBoard> Prepare(const std::string& rig_yaml, std::uint64_t seed, bool lenses_given,
                                                 int captures_max);
  // Another capture, the board at this pose in the camera as it truly sits. Number of cameras that see it whole.
  std::size_t Hold(const SensorId& camera, const Se3& T_camera_board);
  // Cameras that would see it whole.
  [[nodiscard]] std::size_t SeenBy(const SensorId& camera, const Se3& T_camera_board);
  [[nodiscard]] std::size_t Captures() const { return captures_; }
  // Of the rig's sensors, by index and ascending, those that saw it whole in that capture.
  [[nodiscard]] std::vector<std::size_t> SeeingIn(std::size_t capture) const;
  [[nodiscard]] const sim::Experiment& Experiment() const { return experiment_; }
  [[nodiscard]] const Target& Board() const { return experiment_.declared.targets.front(); }
  // All captures as the companion has them.
  [[nodiscard]] companion::Captured Captured();
  // The first `captures` as the refinement of a session takes them, from what is declared; nothing where a camera has
  // no estimate by them.
  [[nodiscard]] std::optional<calib::joint::SessionViews> ViewsOf(std::size_t captures) const;

 private:
  explicit HeldBoard(sim::Experiment experiment) : experiment_(std::move(experiment)) {}
  // The robot stands so that the board, which stays, is there before the camera: the same to every camera.
  void PutRobot(std::size_t capture_idx, const SensorId& camera, const Se3& T_camera_board);

  sim::Experiment experiment_;
  std::size_t captures_ = 0;
  std::map<SensorId, std::map<CaptureId, check::PictureSeen>> pictures_;
  std::unique_ptr<calib::CameraMemory> lenses_ = std::make_unique<calib::CameraMemory>();
};

}  // namespace rigcal
