#include "server/report/models/model_pages.h"

#include <algorithm>

#include "server/report/frame/page.h"
#include "server/report/models/spread_drawing.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kModelsListedMax = 1000;
constexpr std::size_t kOutliersListedMax = 100, kLeftOutListedMax = 50;
constexpr std::array<const char*, 6> kRowNames = {"x", "y", "z", "rx", "ry", "rz"};

void FillAxisRows(Dictionary& card, const SensorPopulation& sensor) {
  for (std::size_t axis = 0; axis < sensor.axes.size(); ++axis) {
    const bool turns = axis >= 3;
    const AxisSpread& spread = sensor.axes[axis];
    Dictionary* row = card.AddSectionDictionary("AXIS");
    row->SetValue("NAME", kRowNames[axis]);
    row->SetValue("UNIT", turns ? "deg" : "mm");
    row->SetValue("MEDIAN", ShownNumber(spread.median, turns));
    row->SetValue("SPREAD", ShownNumber(spread.spread, turns));
    row->SetValue("MIN", ShownNumber(spread.min, turns));
    row->SetValue("MAX", ShownNumber(spread.max, turns));
  }
}

void FillSensorCard(Dictionary& page, const SensorPopulation& sensor) {
  Dictionary* card = page.AddSectionDictionary("SENSOR");
  card->SetValue("NAME", sensor.sensor.str());
  card->SetValue("ROBOTS", Count(sensor.robots.size(), "robot", "robots"));
  if (sensor.T_ref_nominal)
    ShowValue(*card, "DRAWN", "LIMIT",
              Significant(sensor.tolerance.m * kMmPerMetre, 3) + " mm and " +
                  Significant(sensor.tolerance.rad * kDegPerRad, 3) + " deg");
  else
    card->ShowSection("NOT_DRAWN");
  FillSpread(*card, sensor);
  FillAxisRows(*card, sensor);
}

void FillOutlierRows(Dictionary& page, const Population& population) {
  std::size_t listed = 0, all = 0;
  Dictionary* list = nullptr;
  for (const SensorPopulation& sensor : population.sensors)
    for (const PopulationOutlier& outlier : sensor.outliers) {
      ++all;
      if (listed >= kOutliersListedMax) continue;
      if (list == nullptr) list = page.AddSectionDictionary("OUTLIERS");
      ++listed;
      const Vector6d away = outlier.offset - MedianOf(sensor);
      Dictionary* row = list->AddSectionDictionary("OUTLIER");
      row->SetValue("ROBOT", outlier.robot.str());
      row->SetValue("SENSOR", sensor.sensor.str());
      row->SetValue("MM", Significant(away.head<3>().norm() * kMmPerMetre, 3));
      row->SetValue("DEG", Significant(away.tail<3>().norm() * kDegPerRad, 3));
      row->SetValue("AXIS", kRowNames[outlier.worst_axis]);
    }
  if (list != nullptr && listed < all)
    ShowValue(*list, "MORE", "TEXT",
              std::to_string(all - listed) + " more: `rigcal fleet " + population.rig_model + "` lists all.");
}

void FillLeftOutRows(Dictionary& page, const Population& population) {
  if (population.left_out.empty() && population.too_few.empty()) return;
  Dictionary* list = page.AddSectionDictionary("LEFT_OUT");
  for (std::size_t i = 0; i < std::min(population.left_out.size(), kLeftOutListedMax); ++i) {
    Dictionary* row = list->AddSectionDictionary("ROBOT_OUT");
    row->SetValue("ROBOT", population.left_out[i].first.str());
    row->SetValue("WHY", population.left_out[i].second);
  }
  if (population.left_out.size() > kLeftOutListedMax)
    ShowValue(*list, "MORE", "TEXT", std::to_string(population.left_out.size() - kLeftOutListedMax) + " more robots.");
  for (const auto& [sensor, robots] : population.too_few) {
    Dictionary* row = list->AddSectionDictionary("SENSOR_OUT");
    row->SetValue("NAME", sensor.str());
    row->SetValue("ROBOTS", Count(robots, "robot", "robots"));
  }
}

void FillSetBy(Dictionary& page, const Population& population, const std::optional<RigModelVersion>& set) {
  if (!set) return ShowValue(page, "NOT_SET", "NAME", population.rig_model);
  Dictionary* by = page.AddSectionDictionary("SET");
  by->SetValue("VERSION", std::to_string(set->version));
  by->SetValue("WHO", set->word.who);
  by->SetValue("TIME", TimeText(set->word.at));
  by->SetValue("REASON", set->word.reason);
  by->SetValue("TEXT", set->text);
}

}  // namespace

// A name is free text: all but letters and digits is written as its bytes.
std::string PathOfRigModel(const std::string& name) {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string path;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool is_plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') ||
                          (byte >= 'a' && byte <= 'z') || byte == '-' || byte == '_' || byte == '.';
    if (is_plain)
      path += letter;
    else
      path += {'%', kHex[byte >> 4], kHex[byte & 15]};
  }
  return path;
}

Result<std::string> RenderRigModels(const std::vector<RigModelLine>& rows) {
  Dictionary page("models");
  FillHead(page, "Rig models", "../");
  if (rows.empty()) page.ShowSection("EMPTY");
  Dictionary* list = rows.empty() ? nullptr : page.AddSectionDictionary("LIST");
  for (std::size_t i = 0; i < std::min(rows.size(), kModelsListedMax); ++i) {
    Dictionary* row = list->AddSectionDictionary("MODEL");
    row->SetValue("NAME", rows[i].name);
    row->SetValue("PATH", PathOfRigModel(rows[i].name));
    row->SetValue("ROBOTS", std::to_string(rows[i].robots));
    rows[i].version > 0 ? ShowValue(*row, "SET", "VERSION", std::to_string(rows[i].version))
                        : row->ShowSection("NOT_SET");
  }
  if (rows.size() > kModelsListedMax)
    ShowValue(*list, "CUT", "TEXT",
              std::to_string(kModelsListedMax) + " of " + std::to_string(rows.size()) +
                  " rig models are listed, by name; `rigcal model list` lists all.");
  return Expand("models.tpl", page);
}

Result<std::string> RenderRigModel(const Population& population, const std::optional<RigModelVersion>& set) {
  Dictionary page("model");
  FillHead(page, "Rig model " + population.rig_model, "../../");
  page.SetValue("NAME", population.rig_model);
  page.SetValue("SUMMARY",
                Count(population.robots.size(), "robot", "robots") + " with a calibration in use" +
                    (population.reference.empty() ? "" : ", told in the frame of " + population.reference.str()));
  if (!population.why_not.empty()) ShowValue(page, "WHY_NOT", "TEXT", population.why_not);
  for (const std::string& text : OffTheDrawing(population)) ShowValue(page, "OFF", "TEXT", text);
  FillOutlierRows(page, population);
  FillSetBy(page, population, set);
  for (const SensorPopulation& sensor : population.sensors) FillSensorCard(page, sensor);
  FillLeftOutRows(page, population);
  return Expand("model.tpl", page);
}

}  // namespace rigcal::report
