#include <array>
#include <cmath>
#include <utility>

#include "server/base/text.h"
#include "server/model/session.h"

namespace rigcal {
namespace {

constexpr int kCornersMin = 3, kCornersMax = 100;
constexpr double kSquareMin_m = 0.001, kSquareMax_m = 1.0;

Status Refuse(const Checkerboard& target, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "target " + target.id.str() + ": " + what, cure);
}

std::string SizeText(const Checkerboard& target) {
  return std::to_string(target.inner_cols) + "x" + std::to_string(target.inner_rows) + " inner corners";
}

Status CheckCorners(const Checkerboard& target) {
  for (int count : {target.inner_cols, target.inner_rows})
    if (count < kCornersMin || count > kCornersMax)
      return Refuse(target, SizeText(target) + " is out of range",
                    "Count the corners where four squares meet, " + std::to_string(kCornersMin) + " to " +
                        std::to_string(kCornersMax) + " each way.");
  if (target.inner_cols % 2 == target.inner_rows % 2)
    return Refuse(target, SizeText(target) + ", such a board looks the same turned by 180 degrees",
                  "Use a board with one odd and one even count of inner corners, such as 9x6, or cover one row of "
                  "squares and count again.");
  return {};
}

Status CheckSquare(const Checkerboard& target) {
  if (!(target.square_m >= kSquareMin_m && target.square_m <= kSquareMax_m))
    return Refuse(target, "square_m " + std::to_string(target.square_m) + " is out of range",
                  "Give the side of one square in metres, 0.001 to 1.");
  if (!(target.square_sigma_m >= 0.0 && target.square_sigma_m < target.square_m / 2))
    return Refuse(target, "square_sigma_m " + std::to_string(target.square_sigma_m) + " is out of range",
                  "Give the standard deviation of square_m in metres, or 0 if it is exact.");
  return {};
}

}  // namespace

Status Validate(const Checkerboard& target) {
  RIGCAL_TRY(CheckName(TargetTag::kKind, target.id.str()));
  RIGCAL_TRY(CheckCorners(target));
  RIGCAL_TRY(CheckSquare(target));
  if (target.serial.size() > 256 || !IsPrintableUtf8(target.serial))
    return Refuse(target, "serial " + Quoted(target.serial) + " is not one line of readable text",
                  "Use at most 256 bytes of UTF-8 without control characters.");
  return {};
}

}  // namespace rigcal
