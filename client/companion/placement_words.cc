#include "client/companion/placement_words.h"

#include <array>
#include <cmath>

#include "client/check/words.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"

namespace rigcal::companion {
namespace {

using calib::placement::kFocalAxis;
using calib::placement::kGuessSigma_m;
using calib::placement::kGuessSigma_rad;
using calib::placement::NextPlacement;
using client::Fixed;

constexpr double kToldFrom_rad = 0.087;     // 5 degrees
constexpr double kGuessedFrom_ratio = 0.3;  // of the sigma of a guess: nothing tells it yet

std::string Degrees(double rad) { return Fixed(std::round(std::abs(rad) * client::kDegPerRad), 0) + " deg "; }

std::string Sides(double right_rad, double up_rad, const std::string& before) {
  std::vector<std::string> parts;
  if (std::abs(right_rad) >= kToldFrom_rad)
    parts.push_back(Degrees(right_rad) + before + (right_rad > 0 ? "right" : "left"));
  if (std::abs(up_rad) >= kToldFrom_rad) parts.push_back(Degrees(up_rad) + before + (up_rad > 0 ? "up" : "down"));
  return check::Enumerated(parts);
}

bool IsGuess(const NextPlacement& next) {
  return next.axis < kFocalAxis &&
         next.sigma_now > kGuessedFrom_ratio * (next.axis < 3 ? kGuessSigma_m : kGuessSigma_rad);
}

// Never zero: a sigma is not.
std::string SigmaText(double sigma, int digits, const std::string& unit) {
  const double least = std::pow(10.0, -digits);
  return (sigma < least / 2 ? "less than " + Fixed(least, digits) : Fixed(sigma, digits)) + unit;
}

std::string GainText(const NextPlacement& next, const std::string& camera) {
  const std::string what =
      next.axis == kFocalAxis ? "the focal length of " + camera : AxisText(next.axis) + " of " + camera;
  const double scale = next.axis == kFocalAxis ? 100 : next.axis < 3 ? client::kMmPerM : client::kDegPerRad;
  const std::string unit = next.axis == kFocalAxis ? " %" : next.axis < 3 ? " mm" : " deg";
  const int digits = next.axis < 3 ? 1 : 2;
  const std::string then = SigmaText(scale * next.sigma_then, digits, unit);
  if (IsGuess(next)) return what + " becomes known, to " + then;
  return what + " falls from " + SigmaText(scale * next.sigma_now, digits, "") + " to " + then;
}

}  // namespace

std::string SightText(const calib::placement::Stand& stand, const std::string& camera) {
  const std::string sides = Sides(stand.right_rad, stand.up_rad, "");
  return sides.empty() ? "straight before " + camera : sides + " of " + camera;
}

std::string TiltText(const calib::placement::Stand& stand) {
  const double right = stand.tilt_right_rad, up = stand.tilt_up_rad;
  std::vector<std::string> parts;
  if (std::abs(right) >= kToldFrom_rad) parts.push_back(Degrees(right) + (right > 0 ? "to the right" : "to the left"));
  if (std::abs(up) >= kToldFrom_rad) parts.push_back(Degrees(up) + (up > 0 ? "up" : "down"));
  const std::string turned = calib::placement::TurnedAside_rad(stand) > M_PI / 4 ? "on its side, " : "";
  return turned + (parts.empty() ? "facing it" : "tilted " + check::Enumerated(parts));
}

std::string AxisText(int axis) {
  constexpr std::array<const char*, 7> kAxes = {"x",           "y", "z", "turn about x", "turn about y", "turn about z",
                                                "focal length"};
  return kAxes.at(static_cast<std::size_t>(axis));
}

std::string PlacementText(const calib::placement::PlannedRig& rig, const NextPlacement& next) {
  const std::string board = rig.boards.size() > 1 ? "board " + rig.boards[next.board].id.str() : "the board";
  return "Hold " + board + " " + SightText(next.stand, rig.cameras[next.camera].id.str()) + " at " +
         Fixed(next.stand.distance_m, 1) + " m, " + TiltText(next.stand) + ": " +
         GainText(next, rig.cameras[next.of].id.str()) + ".";
}

}  // namespace rigcal::companion
