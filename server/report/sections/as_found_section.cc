#include "server/report/sections/as_found_section.h"

#include <algorithm>
#include <cmath>

#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kFoundSensorsMax = 60;

bool IsShift(int axis) { return axis < tangent::kRotation; }
double Shown(int axis, double value) { return value * (IsShift(axis) ? kMmPerMetre : kDegPerRad); }
std::string WithUnit(int axis, const std::string& number) { return number + (IsShift(axis) ? " mm" : " deg"); }

// As many decimals as its sigma has.
std::string OffBy(int axis, double value, double sigma) {
  return WithUnit(axis, AsCertainAs(Shown(axis, value), Shown(axis, sigma)));
}

const char* FoundLevel(const SensorFound& sensor) {
  if (sensor.state == FoundState::kDrifted) return "warn";
  return sensor.state == FoundState::kUnchanged && CouldTell(sensor) ? "pass" : "unknown";
}

std::string SmallestSeen(int axis, double smallest) {
  return std::isfinite(smallest) ? WithUnit(axis, Significant(Shown(axis, smallest), 2)) : "any may stay unseen";
}

std::string RateText(int axis, const DriftRate& rate) {
  const double sigma = Shown(axis, rate.sigma_per_30_days(axis));
  return AsCertainAs(Shown(axis, rate.per_30_days(axis)), sigma) + " \xC2\xB1 " + WithUnit(axis, Significant(sigma, 2));
}

// Of many axes some are beyond 3 sigma by chance, and the test of all of them says so: only one that drifted has a
// colour.
void FillSigmas(Dictionary& cells, bool drifted, double in_sigmas) {
  Dictionary* figure = cells.AddSectionDictionary(drifted ? "COLOURED" : "PLAIN");
  figure->SetValue("SIGMAS", SigmasText(in_sigmas));
  figure->SetValue("CLASS", SigmasClass(in_sigmas));
}

void FillOff(Dictionary& row, const char* section, const SensorFound& sensor, int axis, double off) {
  Dictionary* cells = row.AddSectionDictionary(section);
  const double sigma = sensor.sigma(axis), in_sigmas = std::abs(off) / sigma;
  cells->SetValue("OFF", OffBy(axis, off, sigma));
  FillSigmas(*cells, sensor.axes[static_cast<std::size_t>(axis)] == FoundState::kDrifted, in_sigmas);
}

void FillAxis(Dictionary& row, const SensorFound& sensor, int axis, bool rates) {
  row.SetValue("AXIS", std::string(tangent::kNames[static_cast<std::size_t>(axis)]));
  if (!IsMeasured(sensor, axis)) return row.ShowSection("OPEN");
  Dictionary* measured = row.AddSectionDictionary("MEASURED");
  FillOff(*measured, "FOUND", sensor, axis, sensor.change(axis));
  if (sensor.left)
    FillOff(*measured, "LEFT", sensor, axis, (*sensor.left)(axis));
  else
    measured->ShowSection("GONE");
  measured->SetValue("SIGMA", WithUnit(axis, Significant(Shown(axis, sensor.sigma(axis)), 2)));
  measured->SetValue("SMALLEST", SmallestSeen(axis, sensor.smallest(axis)));
  if (rates) ShowValue(*measured, "RATE", "TEXT", sensor.rate ? RateText(axis, *sensor.rate) : "");
}

void FillSensor(Dictionary& table, const SensorFound& sensor, bool rates) {
  const bool tested = IsTested(sensor);
  for (int axis = 0; axis < (tested ? 6 : 1); ++axis) {
    Dictionary* row = table.AddSectionDictionary("ROW");
    if (axis == 0) {
      Dictionary* head = row->AddSectionDictionary("SENSOR");
      head->SetValue("NAME", sensor.sensor.str());
      head->SetValue("ROWS", tested ? "6" : "1");
      head->SetValue("LEVEL", FoundLevel(sensor));
      head->SetValue("STATE", WordFor(sensor));
      if (!sensor.or_else.empty()) ShowValue(*head, "OR", "NAME", sensor.or_else.str());
    }
    if (tested)
      FillAxis(*row->AddSectionDictionary("TESTED"), sensor, axis, rates);
    else
      row->ShowSection("UNTESTED");
  }
}

void FillTable(Dictionary& section, const AsFound& found) {
  Dictionary* table = section.AddSectionDictionary("TABLE");
  const bool rates = std::any_of(found.sensors.begin(), found.sensors.end(),
                                 [](const SensorFound& one) { return one.rate.has_value(); });
  if (rates) table->ShowSection("RATE_HEAD");
  if (rates) table->ShowSection("RATE_NOTE");
  table->SetValue("FRAME", found.relative_to.str());
  table->SetValue("ODDS", Significant(100 * found.alpha, 2));
  for (std::size_t s = 0; s < std::min(found.sensors.size(), kFoundSensorsMax); ++s)
    FillSensor(*table, found.sensors[s], rates);
  if (found.sensors.size() > kFoundSensorsMax)
    ShowValue(*table, "MORE", "COUNT", Count(found.sensors.size() - kFoundSensorsMax, "more sensor", "more sensors"));
}

}  // namespace

void FillAsFound(Dictionary& page, const ReportInput& input) {
  if (!input.as_found) return;
  Dictionary* section = page.AddSectionDictionary("AS_FOUND_SECTION")->AddIncludeDictionary("AS_FOUND");
  section->SetFilename("as_found.tpl");
  section->SetValue("TEXT", input.as_found->text);
  section->SetValue("SESSION", input.as_found->session.str());
  section->SetValue("ROBOT", input.revision.robot.str());
  if (input.as_found->why_not.empty()) FillTable(*section, *input.as_found);
}

}  // namespace rigcal::report
