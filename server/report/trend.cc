#include <algorithm>
#include <map>
#include <optional>

#include "server/formats/json_writer.h"
#include "server/report/robot_pages.h"

namespace rigcal::report {
namespace {

using formats::JsonWriter;

struct Row {
  int revision = 0;
  Vector6d d = Vector6d::Zero(), sigma = Vector6d::Zero();
};

struct Trend {
  std::optional<Se3> T_ref_first;
  SensorId reference;
  std::vector<Row> rows;
};

// A new reference begins a new history: poses in different frames are not compared.
void Take(Trend& trend, int number, const SensorId& reference, const SensorPose& pose) {
  if (trend.reference != reference) trend = {std::nullopt, reference, {}};
  if (!trend.T_ref_first) trend.T_ref_first = pose.T_ref_sensor;
  trend.rows.push_back({number, (trend.T_ref_first->Inverse() * pose.T_ref_sensor).Log(),
                        pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt()});
}

void WriteVector(JsonWriter& out, const char* key, const Vector6d& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WriteTrend(JsonWriter& out, const SensorId& sensor, const Trend& trend) {
  out.Text("sensor", sensor.str());
  out.List("rows", [&] {
    for (const Row& row : trend.rows)
      out.Object([&] {
        out.Integer("revision", row.revision);
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
      if (pose.known && pose.sensor != solved.revision->reference)
        Take(trends[pose.sensor], solved.number, solved.revision->reference, pose);
  const std::string json = formats::WriteObject([&](JsonWriter& out) {
    out.List("trends", [&] {
      for (const auto& [sensor, trend] : trends) out.Object([&] { WriteTrend(out, sensor, trend); });
    });
  });
  return "window.rigcal = " + json + ";\n";
}

}  // namespace rigcal::report
