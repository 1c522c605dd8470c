// A board that a person waves before cameras, as where the rig is from the board's side: body poses over time.
#pragma once

#include <cstdint>
#include <vector>

#include "server/math/se3.h"

namespace rigcal {

struct WavedBoardOptions {
  std::uint64_t seed = 1;
  double peak_m_s = 0.3;  // of the board's middle, in the room's air
  double peak_rad_s = 0.8;
  double pause_s = 1.0;  // how long it is held at each place
  bool pauses = true;    // false: it is never held, and wanders over the same places
};

// The board's middle is the body's origin and the world's point `middle_m`. A hand that holds it sways (1 mm, half a
// second) and trembles (0.1 mm, 8 Hz), all the time.
class WavedBoard {
 public:
  // `places`: T_world_body where it is held, one after the other.
  WavedBoard(const std::vector<Se3>& places, const WavedBoardOptions& options);
  [[nodiscard]] double Duration_s() const { return duration_s_; }
  // At a time from 0 to Duration_s().
  [[nodiscard]] Se3 T_world_body(double t_s) const;
  // How fast the body's origin moves there.
  [[nodiscard]] double Speed_m_s(double t_s) const;

 private:
  struct Stretch {
    double begin_s = 0, end_s = 0;
    Se3 from, to;
  };
  [[nodiscard]] Se3 Wandering(double t_s) const;
  [[nodiscard]] Se3 HandAt(double t_s) const;

  WavedBoardOptions options_;
  std::vector<Stretch> stretches_;
  Se3 middle_;                         // of the places, for wandering
  Vector6d reach_ = Vector6d::Zero();  // of the places about it, likewise
  double duration_s_ = 0;
};

}  // namespace rigcal
