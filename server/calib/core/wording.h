// What the sentences of all methods are put together from, and those that several of them say alike.
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/model/diagnosis.h"
#include "server/model/sensors/target.h"

namespace rigcal::calib {

// What was made, or why it was not.
template <typename T>
using OrDiagnosis = tl::expected<T, Diagnosis>;

// A word of a sentence: words, a name or a count.
struct Word {
  // Implicit, so that a list of words may mix them; a number becomes its digits.
  Word(std::string words) : text(std::move(words)) {}
  Word(const char* words) : text(words) {}
  Word(const SensorId& id) : text(id.str()) {}
  Word(const TargetId& id) : text(id.str()) {}
  Word(int count) : text(std::to_string(count)) {}
  Word(std::size_t count) : text(std::to_string(count)) {}
  std::string text;
};
// `pattern` with every "{}" replaced by the next word; words that are left over are not said.
[[nodiscard]] std::string Worded(std::string_view pattern, std::initializer_list<Word> words);

[[nodiscard]] std::string Formatted(const char* format, double value);  // as printf
[[nodiscard]] std::string MillimetresText(double value_m);              // "12 mm"
[[nodiscard]] std::string DegreesText(double value_rad);                // "1.2 deg"
// "(0.99, 0.10, 0.02)": a line has no sign, its largest part is taken as positive.
[[nodiscard]] std::string LineText(const Eigen::Vector3d& axis);

// "1 capture", "3 captures".
[[nodiscard]] std::string CountText(std::size_t count, const std::string& thing = "capture");
[[nodiscard]] std::string OnlyCapturesText(std::size_t count);  // "no capture", "only 3 captures"
// "001, 002, 003 and 9 more".
[[nodiscard]] std::string NamesOf(const std::vector<CaptureId>& captures);
// " The first of them: ...", or nothing.
[[nodiscard]] std::string FirstReason(const std::string& why);
// Captures in which something was not seen, and why in the first of them, as FirstReason().
struct MissedCaptures {
  std::vector<CaptureId> captures;
  std::string first_reason;
  // In the order of the captures: the first call's `why` becomes the reason.
  void Add(const CaptureId& capture, const std::string& why);
};
// What few captures mean for the uncertainty, after "with fewer than 8".
[[nodiscard]] const char* FewMeanText(std::size_t used, std::size_t for_jackknife);

// Cures of a motion that leaves directions open.
inline constexpr const char* kTurnMore =
    "Turn the robot by 20 degrees and more about two different axes; ramps of 5 degrees under its wheels, and turns "
    "on them, help.";
inline constexpr const char* kDriveElsewhere = "Drive the robot to different places between captures. ";

// What is said of a camera by itself, as of one side of a pair, "_a" or "_b": its figure "board_tilt_rad" becomes
// "board_tilt_a_rad".
[[nodiscard]] Diagnosis OfSide(Diagnosis diagnosis, const std::string& side);

// "a and b: what."
[[nodiscard]] Diagnosis AsDiagnosis(const std::string& whose, const std::string& code, const Error& error);
[[nodiscard]] Diagnosis BoardNotFound(const SensorId& camera, const std::string& board, const MissedCaptures& missed);
// "picture_unreadable", "cloud_unreadable": files that hold none; a board was not even looked for.
[[nodiscard]] Diagnosis Unreadable(const SensorId& camera, const MissedCaptures& missed);
[[nodiscard]] Diagnosis CloudsUnreadable(const SensorId& lidar, const MissedCaptures& missed);
// "board_size_suspected": larger than given by `ratio`, as `witnesses` ("picture and cloud") agree with; else the scale
// of `yardstick` ("lidar") may be wrong.
[[nodiscard]] Diagnosis OtherBoardSize(const Target& board, double ratio, double sigma_ratio,
                                       const std::string& witnesses, const std::string& yardstick);
// Notes on a good edge.
[[nodiscard]] Diagnosis IntrinsicsTakenAsExact(const SensorId& camera);
[[nodiscard]] Diagnosis RangeTakenAsExact(const SensorId& lidar);

}  // namespace rigcal::calib
