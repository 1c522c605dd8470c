#include "server/calib/core/wording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rigcal::calib {
namespace {

constexpr std::size_t kNamesShown = 8;
constexpr const char* kCopyAgain = "Copy the files again from where they were recorded, or take those captures again.";

std::string UnreadableText(const char* thing, const SensorId& sensor, const MissedCaptures& missed) {
  return Worded("{} of {} cannot be read and take no part: {}.{}",
                {CountText(missed.captures.size(), thing), sensor, NamesOf(missed.captures), missed.first_reason});
}

}  // namespace

std::string Worded(std::string_view pattern, std::initializer_list<Word> words) {
  std::string sentence;
  std::size_t from = 0;
  for (const Word& word : words) {
    const std::size_t at = pattern.find("{}", from);
    if (at == std::string_view::npos) break;
    sentence.append(pattern.substr(from, at - from)).append(word.text);
    from = at + 2;
  }
  return sentence.append(pattern.substr(from));
}

std::string Formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string MillimetresText(double value_m) { return Formatted("%.0f mm", 1e3 * value_m); }
std::string DegreesText(double value_rad) { return Formatted("%.1f deg", value_rad * 180 / M_PI); }

std::string LineText(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d line = axis[largest] < 0 ? Eigen::Vector3d(-axis) : axis;
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", line.x() + 0.0, line.y() + 0.0, line.z() + 0.0);
  return text;
}

std::string CountText(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}
std::string OnlyCapturesText(std::size_t count) { return count == 0 ? "no capture" : "only " + CountText(count); }

std::string NamesOf(const std::vector<CaptureId>& captures) {
  std::string names;
  for (std::size_t i = 0; i < captures.size() && i < kNamesShown; ++i)
    names += (i == 0 ? "" : ", ") + captures[i].str();
  if (captures.size() > kNamesShown) names += " and " + std::to_string(captures.size() - kNamesShown) + " more";
  return names;
}

std::string FirstReason(const std::string& why) {
  return why.empty() ? "" : " The first of them: " + why + (why.back() == '.' ? "" : ".");
}

const char* FewMeanText(std::size_t used, std::size_t for_jackknife) {
  return used < for_jackknife ? " the uncertainty comes from the model alone and is probably too small."
                              : " the uncertainty is itself uncertain.";
}

void MissedCaptures::Add(const CaptureId& capture, const std::string& why) {
  if (captures.empty()) first_reason = FirstReason(why);
  captures.push_back(capture);
}

Diagnosis OfSide(Diagnosis diagnosis, const std::string& side) {
  std::map<std::string, double> figures;
  for (const auto& [name, value] : diagnosis.figures) {
    const std::size_t unit = std::min(name.rfind('_'), name.size());
    figures.emplace(name.substr(0, unit) + side + name.substr(unit), value);
  }
  diagnosis.figures = std::move(figures);
  return diagnosis;
}

Diagnosis AsDiagnosis(const std::string& whose, const std::string& code, const Error& error) {
  return {code, whose + ": " + error.what + ".", error.cure};
}

Diagnosis BoardNotFound(const SensorId& camera, const std::string& board, const MissedCaptures& missed) {
  return {"board_not_found",
          Worded("{} does not show {} in {}: {}.{}",
                 {camera, board, CountText(missed.captures.size()), NamesOf(missed.captures), missed.first_reason}),
          "Show the whole board, sharp and evenly lit, and check its description in session.yaml."};
}

Diagnosis Unreadable(const SensorId& camera, const MissedCaptures& missed) {
  return {"picture_unreadable", UnreadableText("picture", camera, missed), kCopyAgain};
}

Diagnosis CloudsUnreadable(const SensorId& lidar, const MissedCaptures& missed) {
  return {"cloud_unreadable", UnreadableText("cloud", lidar, missed), kCopyAgain};
}

Diagnosis OtherBoardSize(const Target& board, double ratio, double sigma_ratio, const std::string& witnesses,
                         const std::string& yardstick) {
  const auto mm = [](double value_m) { return Formatted("%.2f", 1e3 * value_m); };
  return {
      "board_size_suspected",
      Worded("The size of target '{}' seems to be {} % {} than given: {} agree with {} mm (+- {}) instead of {} mm.",
             {board.id, Formatted("%.2f", 100 * std::abs(ratio)), ratio > 0 ? "larger" : "smaller", witnesses,
              mm(board.square_m * (1 + ratio)), mm(board.square_m * sigma_ratio), mm(board.square_m)}),
      Worded("Measure the board across many squares and correct its size in session.yaml; if it is right, the "
             "camera's focal length or the {}'s scale is wrong.",
             {yardstick})};
}

Diagnosis IntrinsicsTakenAsExact(const SensorId& camera) {
  return {"intrinsics_taken_as_exact",
          Worded("The intrinsics of {} are given without an uncertainty and taken as exact.", {camera}),
          "Give 'sigma' with the intrinsics in session.yaml, or leave the intrinsics out to have them estimated."};
}

Diagnosis RangeTakenAsExact(const SensorId& lidar) {
  return {"range_taken_as_exact",
          Worded("The ranges of {} are taken as free of an error that all of them share.", {lidar}),
          "Give range_bias_sigma_m in session.yaml, such as the range accuracy of its data sheet, and it becomes part "
          "of the uncertainty."};
}

}  // namespace rigcal::calib
