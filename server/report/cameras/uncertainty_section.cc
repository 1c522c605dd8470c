#include "server/report/cameras/uncertainty_section.h"

#include <algorithm>

#include "server/model/sensors/coverage.h"
#include "server/report/cameras/field_map.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string WhyNoUncertainty(const CameraFit& fit) {
  if (fit.source == IntrinsicsSource::kGiven)
    return fit.sigma.empty()
               ? "The intrinsics were given in session.yaml without a covariance: how far off projections may be is "
                 "not known. Give their sigma, too, or leave them away: then they are estimated with one."
               : "The intrinsics were given in session.yaml as exact: by them, no projection is uncertain.";
  if (fit.sigma.empty())
    return "The pictures leave a value of the intrinsics open: how far off projections may be is not known. Take more "
           "pictures, "
           "with the board tilted and near all borders of the picture.";
  return "This camera was calibrated by a version that did not keep the covariance of the intrinsics: its next session "
         "has the map.";
}

struct DistanceMap {
  std::string title, aria;
  FieldMap map;
  std::optional<double> middle_px;
};

DistanceMap MapOf(const CameraReport& camera, const std::string& title, const std::string& point,
                  std::optional<double> PointSigma::*sigma_px) {
  const ProjectionUncertainty& uncertainty = *camera.uncertainty;
  DistanceMap one{title,
                  "Standard deviation of where " + point + " is projected, by fields of the picture",
                  {},
                  uncertainty.middle.*sigma_px};
  one.map = {camera.fit.width_px, camera.fit.height_px, uncertainty.columns, uncertainty.rows, {}, {}};
  for (const PointSigma& field : uncertainty.fields) one.map.value_px.push_back(field.*sigma_px);
  for (const int corners : CoverageOf(camera.fit).corners) one.map.seen.push_back(corners > 0);
  one.map.seen.resize(one.map.value_px.size(), false);
  return one;
}

std::string FiguresText(const DistanceMap& one) {
  std::string text = one.middle_px ? PixelsText(*one.middle_px) + " in the middle" : "no ray in the middle";
  if (const auto worst = WorstOf(one.map))
    text += ", at most " + PixelsText(worst->value_px) + " (" + worst->where + ")";
  const auto of_seen = WorstOf(one.map, one.map.seen);
  if (of_seen && std::find(one.map.seen.begin(), one.map.seen.end(), false) != one.map.seen.end())
    text += "; where corners were seen, at most " + PixelsText(of_seen->value_px);
  return text;
}

void FillOneMap(Dictionary& section, const DistanceMap& one) {
  const std::string figures = FiguresText(one);
  const bool hatched = std::find(one.map.seen.begin(), one.map.seen.end(), false) != one.map.seen.end();
  Dictionary* shown = section.AddSectionDictionary("MAP");
  shown->SetValue("TITLE", one.title);
  shown->SetValue("FIGURES", figures);
  FillFieldMap(*shown, one.map,
               one.aria + ": " + figures + (hatched ? ". No corners were seen in the hatched fields." : "."));
}

}  // namespace

void FillUncertainty(Dictionary& section, const CameraReport& camera) {
  if (camera.fit.source == IntrinsicsSource::kNone) return;
  if (!camera.uncertainty) return ShowValue(section, "NO_UNCERTAINTY", "TEXT", WhyNoUncertainty(camera.fit));
  Dictionary* maps = section.AddSectionDictionary("UNCERTAINTY");
  const std::string near = Significant(kNearPoint_m, 1) + " m away";
  const DistanceMap far_map = MapOf(camera, "A point far away", "a point far away", &PointSigma::far_px);
  FillOneMap(*maps, far_map);
  FillOneMap(*maps, MapOf(camera, "A point " + near, "a point " + near, &PointSigma::near_px));
  if (std::find(far_map.map.seen.begin(), far_map.map.seen.end(), false) != far_map.map.seen.end())
    maps->ShowSection("HATCHED");
}

}  // namespace rigcal::report
