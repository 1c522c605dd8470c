// Numbers and words for people: millimetres, degrees, significant digits. Locale-independent; never "nan" or "inf".
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <string>

#include "server/base/stamp.h"
#include "server/model/approval/standing.h"
#include "server/model/diagnosis.h"

namespace rigcal::report {

inline constexpr double kMmPerMetre = 1000.0;
inline constexpr double kDegPerRad = 57.295779513082320877;

// Fixed decimals, no "-0.00"; "not known" for what is not finite.
[[nodiscard]] std::string Fixed(double value, int decimals);
// `digits` significant digits, in fixed notation between 1e-4 and 1e7.
[[nodiscard]] std::string Significant(double value, int digits);
// As many decimals as sigma has with two digits; at most six digits where sigma is not known.
[[nodiscard]] std::string AsCertainAs(double value, double sigma);
[[nodiscard]] std::string Mm(double value_m);       // 2 decimals
[[nodiscard]] std::string Deg(double value_rad);    // 3 decimals
[[nodiscard]] std::string SigmaMm(double value_m);  // 2 significant digits
[[nodiscard]] std::string SigmaDeg(double value_rad);

// R = Rz(yaw) Ry(pitch) Rx(roll), radians; where pitch is +-90 deg, roll is 0.
struct RollPitchYaw {
  double roll = 0.0, pitch = 0.0, yaw = 0.0;
};
// `q` is a unit quaternion.
[[nodiscard]] RollPitchYaw RollPitchYawOf(const Eigen::Quaterniond& q);

// "reprojection_rms_px", 0.21 -> "reprojection rms", "0.21 px"; _m as mm, _rad as deg.
[[nodiscard]] std::string FigureName(const std::string& figure);
[[nodiscard]] std::string FigureValue(const std::string& figure, double value);
// What is shown behind the number, with its space, and what the figure is multiplied by for it.
struct FigureUnit {
  std::string shown;
  double scale = 1.0;
};
// Of what has no unit, or one that is not known: nothing, and 1.
[[nodiscard]] FigureUnit UnitOfFigure(const std::string& figure);

// Any words as a value in an address.
[[nodiscard]] std::string InAddress(const std::string& words);
[[nodiscard]] std::string Count(std::size_t count, const std::string& one, const std::string& many);  // "1 edge"
[[nodiscard]] std::string TimeText(Stamp stamp);  // "2026-01-31 12:00:00 UTC"
[[nodiscard]] std::string VerdictWord(VerdictLevel level);
// "pushed again", "restored by Ada (the squares were wrong)"
[[nodiscard]] std::string HowText(const Standing& standing);
[[nodiscard]] std::string ShortDigest(const std::string& digest);  // 12 digits

}  // namespace rigcal::report
