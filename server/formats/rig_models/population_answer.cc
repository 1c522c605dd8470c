#include "server/formats/json/json_values.h"
#include "server/formats/rig_models/rig_model_answers.h"

namespace rigcal::formats {
namespace {

constexpr std::array<const char*, 6> kAxisNames = {"x", "y", "z", "rx", "ry", "rz"};

void WriteAxisSpread(JsonWriter& out, std::size_t axis, const AxisSpread& spread) {
  const std::string unit = axis < 3 ? "_m" : "_rad";
  out.Text("axis", kAxisNames[axis]);
  out.Number("min" + unit, spread.min);
  out.Number("lower_quartile" + unit, spread.lower);
  out.Number("median" + unit, spread.median);
  out.Number("upper_quartile" + unit, spread.upper);
  out.Number("max" + unit, spread.max);
  out.Number("spread" + unit, spread.spread);
}

void WriteOutlier(JsonWriter& out, const PopulationOutlier& outlier) {
  out.Text("robot", outlier.robot.str());
  WriteVector(out, "offset", outlier.offset);
  out.Text("worst_axis", kAxisNames[outlier.worst_axis]);
  out.Number("odds", outlier.odds);
}

void WriteSensorPopulation(JsonWriter& out, const SensorPopulation& sensor) {
  out.Text("id", sensor.sensor.str());
  sensor.T_ref_nominal ? WritePose(out, "T_ref_nominal", *sensor.T_ref_nominal) : out.Null("T_ref_nominal");
  WritePose(out, "T_ref_center", sensor.T_ref_center);
  const bool drawn = sensor.T_ref_nominal.has_value();
  drawn ? out.Number("tolerance_m", sensor.tolerance.m) : out.Null("tolerance_m");
  drawn ? out.Number("tolerance_rad", sensor.tolerance.rad) : out.Null("tolerance_rad");
  out.Integer("robots", static_cast<std::int64_t>(sensor.robots.size()));
  out.Text("test", sensor.by_distance ? "distance" : "axes");
  out.List("axes", [&] {
    for (std::size_t axis = 0; axis < sensor.axes.size(); ++axis)
      out.Object([&] { WriteAxisSpread(out, axis, sensor.axes[axis]); });
  });
  out.List("outliers", [&] {
    for (const PopulationOutlier& outlier : sensor.outliers) out.Object([&] { WriteOutlier(out, outlier); });
  });
}

void WriteLeftOut(JsonWriter& out, const Population& population) {
  out.List("left_out", [&] {
    for (const auto& [robot, why] : population.left_out)
      out.Object([&] {
        out.Text("robot", robot.str());
        out.Text("why", why);
      });
  });
  out.List("too_few", [&] {
    for (const auto& [sensor, robots] : population.too_few)
      out.Object([&] {
        out.Text("id", sensor.str());
        out.Integer("robots", static_cast<std::int64_t>(robots));
      });
  });
}

void WriteTexts(JsonWriter& out, std::string_view key, const std::vector<std::string>& texts) {
  out.List(key, [&] {
    for (const std::string& text : texts) out.Text(text);
  });
}

}  // namespace

std::string WritePopulation(const Population& population) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("rig_model", population.rig_model);
    population.version > 0 ? out.Integer("version", population.version) : out.Null("version");
    population.reference.empty() ? out.Null("reference") : out.Text("reference", population.reference.str());
    out.Integer("robots", static_cast<std::int64_t>(population.robots.size()));
    population.why_not.empty() ? out.Null("why_not") : out.Text("why_not", population.why_not);
    WriteTexts(out, "off_the_drawing", OffTheDrawing(population));
    WriteTexts(out, "outlier_texts", OutlierTexts(population));
    WriteLeftOut(out, population);
    out.List("sensors", [&] {
      for (const SensorPopulation& sensor : population.sensors) out.Object([&] { WriteSensorPopulation(out, sensor); });
    });
  });
}

}  // namespace rigcal::formats
