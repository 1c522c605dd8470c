#include "tests/bench/trust/trust_json.h"

#include <algorithm>

#include "tests/bench/trust/told_words.h"

namespace rigcal {
namespace {

template <typename Ids>
void WriteIds(std::string_view key, const Ids& ids, formats::JsonWriter& out) {
  out.List(key, [&] {
    for (const auto& id : ids) out.Text(id.str());
  });
}

std::vector<SensorId> SensorsOf(const JudgedVisit& judged) {
  std::vector<SensorId> sensors;
  for (const sim::RigSensor& sensor : judged.experiment.rig.sensors) sensors.push_back(sensor.id);
  return sensors;
}

// What the session as a whole is said to be, not one of its pairs.
void WriteAccused(const JudgedVisit& judged, formats::JsonWriter& out) {
  const std::vector<SensorId> sensors = SensorsOf(judged);
  std::set<SensorId> moved, lens;
  std::set<CaptureId> when;
  bool moved_said = false;
  for (const Said& said : judged.told.said) {
    if (!said.about.empty()) continue;
    if (SaysMoved(said.text)) {
      moved_said = true;
      moved.merge(SensorsIn(said.text, sensors));
      when.merge(CapturesIn(said.text, judged.experiment.captures));
    }
    if (SaysLens(said.text)) lens.merge(SensorsIn(said.text, sensors));
  }
  out.Flag("moved_said", moved_said);
  WriteIds("moved_sensors", moved, out);
  WriteIds("moved_captures", when, out);
  WriteIds("lens_sensors", lens, out);
}

// Anyone who names the picture: its sensor, or a pair of it, and its capture in one sentence.
bool IsNamed(const JudgedVisit& judged, const SensorId& sensor, const CaptureId& capture) {
  return std::any_of(judged.told.said.begin(), judged.told.said.end(), [&](const Said& said) {
    const bool of_sensor = said.about.contains(sensor) || !SensorsIn(said.text, {sensor}).empty();
    return of_sensor && !CapturesIn(said.text, {capture}).empty();
  });
}

void WriteTruth(const JudgedVisit& judged, formats::JsonWriter& out) {
  const sim::Experiment& truth = judged.experiment;
  if (truth.options.bump) {
    out.Text("bumped", truth.options.bump->str());
    out.Integer("bumped_from_idx", static_cast<std::int64_t>(truth.bumped_from_idx));
  }
  const auto one_picture = [&](const SensorId& sensor, std::size_t capture_idx) {
    out.Text("picture_sensor", sensor.str());
    out.Text("picture_capture", truth.captures[capture_idx].str());
    out.Flag("picture_named", IsNamed(judged, sensor, truth.captures[capture_idx]));
  };
  if (truth.shifted) one_picture(truth.shifted->sensor, truth.shifted->capture_idx);
  if (truth.wrong_instant) one_picture(truth.wrong_instant->sensor, truth.wrong_instant->capture_idx);
  if (truth.displaced) out.Text("displaced", truth.displaced->str());
  if (truth.refocused) out.Text("refocused", truth.refocused->sensor.str());
  if (truth.moved_board) {
    const std::string board = truth.moved_board->board.str();
    out.Text("moved_board", board);
    out.Flag("moved_board_named", judged.told.verdict.why.find("board " + board) != std::string::npos);
  }
}

// What is true of trackers' clocks, and what is told.
void WriteClocks(const JudgedVisit& judged, formats::JsonWriter& out) {
  out.Number("clock_late_s", judged.experiment.options.disturb.pose_clock_late_s);
  out.List("clocks", [&] {
    for (const TrackerClock& clock : judged.told.clocks)
      out.Object([&] {
        out.Number("late_s", clock.late_s);
        out.Number("sigma_s", clock.sigma_s);
      });
  });
}

void WriteSix(std::string_view key, const Vector6d& values, formats::JsonWriter& out) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WritePose(const PoseFigures& pose, formats::JsonWriter& out) {
  out.Flag("known", pose.known);
  if (!pose.known) return;
  WriteSix("e", pose.errors.front(), out);
  WriteSix("sigma", pose.covariance.diagonal().cwiseMax(0).cwiseSqrt(), out);
  out.List("t2", [&] {
    for (const Vector6d& error : pose.errors) out.Number(error.dot(pose.covariance.ldlt().solve(error)));
  });
  if (pose.error_after) out.Number("t2_after", pose.error_after->dot(pose.covariance.ldlt().solve(*pose.error_after)));
  out.Number("limit", pose.limit);
  if (!pose.bound) return;
  out.List("bound", [&] {
    for (const std::optional<double>& sigma : *pose.bound) sigma ? out.Number(*sigma) : out.Null();
  });
}

}  // namespace

void WriteJudged(const JudgedVisit& judged, formats::JsonWriter& out) {
  out.Object([&] {
    out.Integer("seed", static_cast<std::int64_t>(judged.visit.options.seed));
    out.Text("verdict", NameOf(judged.told.verdict.level));
    out.Text("why", judged.told.verdict.why);
    out.Text("what_to_do", judged.told.verdict.what_to_do);
    if (!judged.told.not_refined.empty()) out.Text("not_refined", judged.told.not_refined);
    out.Integer("failed_edges", judged.told.failed_edges);
    out.Number("judge_s", judged.judge_s);
    WriteTruth(judged, out);
    WriteAccused(judged, out);
    WriteClocks(judged, out);
    out.Object("sensors", [&] {
      for (const auto& [id, pose] : judged.poses) out.Object(id.str(), [&] { WritePose(pose, out); });
    });
  });
}

}  // namespace rigcal
