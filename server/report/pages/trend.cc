#include <algorithm>
#include <map>
#include <optional>

#include "server/formats/json/json_writer.h"
#include "server/report/robot_pages.h"
#include "server/report/text/changes.h"

namespace rigcal::report {
namespace {

using formats::JsonWriter;

// One solved state in the history: a revision, or what a visit says by itself.
struct State {
  int revision = 0;  // 0: of a visit
  SessionId session;
  Stamp at;
  SensorId reference;
};

struct Row {
  State state;
  std::optional<SensorMove> step;  // since the row before
  bool remounted = false;          // since then, on purpose: no step is told
  Vector6d d = Vector6d::Zero(), sigma = Vector6d::Zero();
};

struct Trend {
  std::optional<Se3> T_ref_first;
  std::optional<SensorPose> last;
  std::vector<Row> rows;
};
using Trends = std::map<SensorId, Trend>;

bool BeganBetween(const std::vector<Epoch>& epochs, const SensorId& sensor, const State& before, const State& now) {
  return std::any_of(epochs.begin(), epochs.end(), [&](const Epoch& epoch) {
    return (epoch.sensor == sensor || epoch.sensor == now.reference) && before.at.ns < epoch.begins_at.ns &&
           epoch.begins_at.ns <= now.at.ns;
  });
}

// Revisions have most of what they count in common: the larger sigma is that of the step. Visits have nothing in common
// but what errs alike on each of them: their covariances add up, which may be too much and never too little.
SensorMove StepOf(const SensorPose& before, SensorPose now, const State& state) {
  if (state.revision == 0) now.covariance += before.covariance;
  return MoveOf(before, now);
}

// A new reference begins a new history: poses in different frames are not compared.
void Take(const State& state, const std::vector<SensorPose>& poses, const std::vector<Epoch>& epochs, Trends& trends) {
  for (const SensorPose& pose : poses) {
    if (!pose.known || pose.sensor == state.reference) continue;
    Trend& trend = trends[pose.sensor];
    if (!trend.rows.empty() && trend.rows.back().state.reference != state.reference) trend = {};
    if (!trend.T_ref_first) trend.T_ref_first = pose.T_ref_sensor;
    Row row{state, std::nullopt, false, (trend.T_ref_first->Inverse() * pose.T_ref_sensor).Log(),
            pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt()};
    if (trend.last) row.remounted = BeganBetween(epochs, pose.sensor, trend.rows.back().state, state);
    if (trend.last && !row.remounted) row.step = StepOf(*trend.last, pose, state);
    trend.last = pose;
    trend.rows.push_back(std::move(row));
  }
}

void WriteVector(JsonWriter& out, const char* key, const Vector6d& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WriteStep(JsonWriter& out, const SensorMove& step) {
  out.Number("moved_m", step.distance_m);
  out.Number("turned_rad", step.angle_rad);
  out.Number("in_sigmas", step.in_sigmas);
}

void WriteRow(JsonWriter& out, const Row& row) {
  if (row.state.revision > 0) out.Integer("revision", row.state.revision);
  if (!row.state.session.empty()) out.Text("session", row.state.session.str());
  if (row.state.at.ns > 0) out.Text("date", ToIso(row.state.at).substr(0, 10));
  if (row.step) WriteStep(out, *row.step);
  if (row.remounted) out.Flag("remounted", true);
  WriteVector(out, "d", row.d);
  WriteVector(out, "sigma", row.sigma);
}

void WriteRows(JsonWriter& out, const char* key, const std::vector<Row>& rows) {
  out.List(key, [&] {
    for (const Row& row : rows) out.Object([&] { WriteRow(out, row); });
  });
}

// One visit alone is no series.
void WriteTrend(JsonWriter& out, const SensorId& sensor, const Trend& trend, const Trends& visits) {
  out.Text("sensor", sensor.str());
  WriteRows(out, "rows", trend.rows);
  const auto by_visit = visits.find(sensor);
  if (by_visit != visits.end() && by_visit->second.rows.size() > 1) WriteRows(out, "visits", by_visit->second.rows);
}

}  // namespace

std::string TrendData(const std::vector<SolvedRevision>& revisions, const std::vector<Visit>& visits,
                      const std::vector<Epoch>& epochs) {
  Trends trends, by_visit;
  for (const SolvedRevision& solved : revisions)
    Take({solved.number, SessionId(), solved.calibrated_at, solved.revision->reference},
         solved.revision->solution.poses, epochs, trends);
  for (const Visit& visit : visits)
    Take({0, visit.session, visit.captured_at, visit.reference}, visit.poses, epochs, by_visit);
  const std::string json = formats::WriteObject([&](JsonWriter& out) {
    out.List("trends", [&] {
      for (const auto& [sensor, trend] : trends) out.Object([&] { WriteTrend(out, sensor, trend, by_visit); });
    });
  });
  return "window.rigcal = " + json + ";\n";
}

}  // namespace rigcal::report
