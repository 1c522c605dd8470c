#include <algorithm>
#include <map>
#include <optional>

#include "server/formats/json/json_writer.h"
#include "server/report/robot_pages.h"
#include "server/report/text/changes.h"

namespace rigcal::report {
namespace {

using formats::JsonWriter;

struct Row {
  int revision = 0;
  Stamp calibrated_at;
  std::optional<SensorMove> step;  // since the row before
  Vector6d d = Vector6d::Zero(), sigma = Vector6d::Zero();
};

struct Trend {
  std::optional<Se3> T_ref_first;
  std::optional<SensorPose> last;
  SensorId reference;
  std::vector<Row> rows;
};

// A new reference begins a new history: poses in different frames are not compared.
void Take(Trend& trend, const SolvedRevision& solved, const SensorPose& pose) {
  const SensorId& reference = solved.revision->reference;
  if (trend.reference != reference) trend = {std::nullopt, std::nullopt, reference, {}};
  if (!trend.T_ref_first) trend.T_ref_first = pose.T_ref_sensor;
  std::optional<SensorMove> step;
  if (trend.last) step = MoveOf(*trend.last, pose);
  trend.last = pose;
  trend.rows.push_back({solved.number, solved.calibrated_at, std::move(step),
                        (trend.T_ref_first->Inverse() * pose.T_ref_sensor).Log(),
                        pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt()});
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

void WriteTrend(JsonWriter& out, const SensorId& sensor, const Trend& trend) {
  out.Text("sensor", sensor.str());
  out.List("rows", [&] {
    for (const Row& row : trend.rows)
      out.Object([&] {
        out.Integer("revision", row.revision);
        if (row.calibrated_at.ns > 0) out.Text("date", ToIso(row.calibrated_at).substr(0, 10));
        if (row.step) WriteStep(out, *row.step);
        WriteVector(out, "d", row.d);
        WriteVector(out, "sigma", row.sigma);
      });
  });
}

}  // namespace

std::string TrendData(const std::vector<SolvedRevision>& revisions) {
  std::map<SensorId, Trend> trends;
  for (const SolvedRevision& solved : revisions)
    for (const SensorPose& pose : solved.revision->solution.poses)
      if (pose.known && pose.sensor != solved.revision->reference) Take(trends[pose.sensor], solved, pose);
  const std::string json = formats::WriteObject([&](JsonWriter& out) {
    out.List("trends", [&] {
      for (const auto& [sensor, trend] : trends) out.Object([&] { WriteTrend(out, sensor, trend); });
    });
  });
  return "window.rigcal = " + json + ";\n";
}

}  // namespace rigcal::report
