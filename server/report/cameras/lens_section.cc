#include "server/report/cameras/lens_section.h"

#include <algorithm>

#include "server/report/cameras/field_map.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kLensMapsMax = 24, kLensNamesMax = 20;

struct DrawnLens {
  const LensChange* change = nullptr;
  FieldMap map;
  std::optional<WorstField> worst;
};

DrawnLens DrawnOf(const LensChange& change) {
  DrawnLens lens{&change, {change.width_px, change.height_px, change.columns, change.rows, {}, change.seen}, {}};
  lens.map.arrow_px = change.shift_px;
  for (const auto& shift_px : change.shift_px)
    lens.map.value_px.push_back(shift_px ? std::optional<double>(shift_px->norm()) : std::nullopt);
  lens.worst = WorstOf(lens.map);
  return lens;
}

std::vector<DrawnLens> FarthestFirst(const std::vector<LensChange>& changes) {
  std::vector<DrawnLens> lenses;
  for (const LensChange& change : changes) lenses.push_back(DrawnOf(change));
  const auto worst_px = [](const DrawnLens& lens) { return lens.worst ? lens.worst->value_px : 0.0; };
  std::sort(lenses.begin(), lenses.end(), [&](const DrawnLens& x, const DrawnLens& y) {
    return worst_px(x) != worst_px(y) ? worst_px(x) > worst_px(y) : x.change->camera < y.change->camera;
  });
  return lenses;
}

std::string ShiftText(const DrawnLens& lens) {
  if (!lens.worst) return "no ray of the one lens is one of the other";
  std::string text = "at most " + PixelsText(lens.worst->value_px) + " (" + lens.worst->where + ")";
  if (const auto middle_px = MiddleValue(lens.map)) text += ", " + PixelsText(*middle_px) + " in the middle";
  const std::vector<bool>& seen = lens.change->seen;
  const auto of_seen = WorstOf(lens.map, seen);
  if (of_seen && std::find(seen.begin(), seen.end(), false) != seen.end())
    text += "; where both saw corners, at most " + PixelsText(of_seen->value_px);
  return text;
}

std::string TurnText(double turn_deg) {
  constexpr double kLeast_deg = 0.001;
  return turn_deg < kLeast_deg ? "less than " + Significant(kLeast_deg, 1) : Significant(turn_deg, 2);
}

void FillLens(Dictionary& row, const DrawnLens& lens) {
  const std::string shift = ShiftText(lens);
  row.SetValue("CAMERA", lens.change->camera.str());
  row.SetValue("SHIFT", shift);
  row.SetValue("TURN", TurnText(lens.change->turn_rad * kDegPerRad));
  FillFieldMap(row, lens.map,
               "How far a point far away is projected from where it was, by fields of the picture of " +
                   lens.change->camera.str() + ": " + shift + ".");
}

std::string CamerasText(const std::vector<SensorId>& cameras) {
  std::string names;
  for (std::size_t i = 0; i < std::min(cameras.size(), kLensNamesMax); ++i)
    names += (i == 0 ? "" : ", ") + cameras[i].str();
  if (cameras.size() > kLensNamesMax) names += " and " + std::to_string(cameras.size() - kLensNamesMax) + " more";
  return names;
}

void FillNotCompared(Dictionary& section, const ComparedLenses& lenses) {
  for (std::size_t i = 0; i < std::min(lenses.not_compared.size(), kLensNamesMax); ++i) {
    Dictionary* row = section.AddSectionDictionary("NOT_COMPARED");
    row->SetValue("CAMERA", lenses.not_compared[i].first.str());
    row->SetValue("WHY", lenses.not_compared[i].second);
  }
  if (lenses.not_compared.size() > kLensNamesMax)
    ShowValue(section, "MORE_NOT_COMPARED", "COUNT",
              Count(lenses.not_compared.size() - kLensNamesMax, "camera", "cameras"));
}

}  // namespace

void FillLenses(Dictionary& page, const ComparedLenses& lenses) {
  if (lenses.changes.empty() && lenses.same.empty() && lenses.not_compared.empty()) return;
  Dictionary* section = page.AddSectionDictionary("LENSES");
  const std::vector<DrawnLens> drawn = FarthestFirst(lenses.changes);
  if (!drawn.empty()) section->ShowSection("EXPLAINED");
  for (std::size_t i = 0; i < std::min(drawn.size(), kLensMapsMax); ++i)
    FillLens(*section->AddSectionDictionary("LENS"), drawn[i]);
  if (drawn.size() > kLensMapsMax)
    ShowValue(*section, "MORE_LENSES", "COUNT", Count(drawn.size() - kLensMapsMax, "camera", "cameras"));
  if (!lenses.same.empty()) ShowValue(*section, "SAME", "NAMES", CamerasText(lenses.same));
  FillNotCompared(*section, lenses);
}

}  // namespace rigcal::report
