#include "server/report/cameras/camera_section.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/report/cameras/camera_drawing.h"
#include "server/report/cameras/camera_views.h"
#include "server/report/cameras/uncertainty_section.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kOpenMax = 3;       // more cameras than this start folded
constexpr std::size_t kCamerasMax = 100;  // with pictures; the rest is in the table

const Edge* EdgeOf(const ReportInput& input, const EdgeId& id) {
  const auto at = std::find_if(input.revision.edges.begin(), input.revision.edges.end(),
                               [&](const Edge& edge) { return edge.id == id; });
  return at == input.revision.edges.end() ? nullptr : &*at;
}

std::string AnchorOf(const CameraReport& camera) { return "c-" + camera.document.str().substr(0, 16); }

std::string SourceText(const CameraFit& fit) {
  if (fit.source == IntrinsicsSource::kNone) return "not solved";
  if (fit.source == IntrinsicsSource::kGiven) return "given";
  return fit.source == IntrinsicsSource::kRefined ? "refined" : "estimated";
}

std::string SigmaSourceText(const CameraReport& camera) {
  const CameraFit& fit = camera.fit;
  if (!camera.refined_in.empty())
    return "refined with all sensors' poses of session " + camera.refined_in.str().substr(0, 12) +
           ", to which it belongs; pictures below are fitted by themselves";
  if (fit.source == IntrinsicsSource::kGiven)
    return fit.sigma.empty() ? "given in session.yaml without a sigma: taken as exact"
                             : "given in session.yaml with this sigma";
  if (fit.source == IntrinsicsSource::kRefined)
    return "given in session.yaml and refined by the pictures; this is the sigma of both together";
  if (fit.sigma.empty()) return "sigma is not known: the pictures leave a value open";
  return fit.sigma_by_jackknife ? "sigma from a jackknife over the pictures"
                                : "sigma from the scatter of the corners: too few pictures for a jackknife";
}

struct Value {
  std::string name;
  double value = 0.0;
  bool in_px = false;
};

std::vector<Value> ValuesOf(const CameraIntrinsics& intrinsics) {
  std::vector<Value> values = {{"fx", intrinsics.fx_px, true},
                               {"fy", intrinsics.fy_px, true},
                               {"cx", intrinsics.cx_px, true},
                               {"cy", intrinsics.cy_px, true}};
  const std::vector<std::string>& names = DistortionNames(intrinsics.model);
  for (std::size_t i = 0; i < std::min(names.size(), intrinsics.distortion.size()); ++i)
    values.push_back({names[i], intrinsics.distortion[i], false});
  return values;
}

// A sigma of exactly zero belongs to a value that was not estimated.
std::string SigmaText(const CameraFit& fit, double sigma) {
  if (sigma > 0) return "\xC2\xB1 " + Significant(sigma, 2);
  if (!fit.sigma.empty()) return "held";
  return fit.source == IntrinsicsSource::kGiven ? "" : "\xC2\xB1 not known";
}

std::string ModelText(CameraModel model) {
  switch (model) {
    case CameraModel::kPinholeRational:
      return "pinhole with rational distortion";
    case CameraModel::kFisheyeKb4:
      return "fisheye (Kannala-Brandt)";
    case CameraModel::kEucm:
      return "enhanced unified camera model";
    case CameraModel::kDoubleSphere:
      return "double sphere";
    case CameraModel::kPinholeRadtan:
      break;
  }
  return "pinhole with radial and tangential distortion";
}

void FillIntrinsics(Dictionary& section, const CameraReport& camera) {
  const CameraFit& fit = camera.fit;
  if (fit.source == IntrinsicsSource::kNone) return;
  Dictionary* table = section.AddSectionDictionary("INTRINSICS");
  table->SetValue("MODEL", ModelText(fit.intrinsics.model));
  table->SetValue("SIGMA_FROM", SigmaSourceText(camera));
  const std::vector<Value> values = ValuesOf(fit.intrinsics);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double sigma = i < fit.sigma.size() ? fit.sigma[i] : 0.0;
    Dictionary* row = table->AddSectionDictionary("VALUE");
    row->SetValue("NAME", values[i].name);
    row->SetValue("VALUE", AsCertainAs(values[i].value, sigma));
    row->SetValue("SIGMA", SigmaText(fit, sigma));
    row->SetValue("UNIT", values[i].in_px ? "px" : "");
  }
}

// The focal lengths that the camera's other edges found from captures of their own.
std::string OtherEdgesText(const ReportInput& input, const CameraReport& camera) {
  std::vector<double> focal_px;
  for (const Edge& edge : input.revision.edges) {
    if (edge.state != EdgeState::kGood || edge.id == camera.edge) continue;
    const bool is_a = edge.frame_a == camera.fit.camera, is_b = edge.frame_b == camera.fit.camera;
    if (!is_a && !is_b) continue;
    for (const char* name : {is_a ? "fx_a_px" : "fx_b_px", "fx_px"})
      if (const auto found = edge.figures.find(name); found != edge.figures.end()) focal_px.push_back(found->second);
  }
  if (focal_px.empty() || camera.fit.source != IntrinsicsSource::kEstimated) return "";
  const auto [low, high] = std::minmax_element(focal_px.begin(), focal_px.end());
  return "By themselves, " + Count(focal_px.size(), "other edge finds", "other edges find") + " fx " +
         (focal_px.size() == 1 ? Fixed(*low, 2) : "from " + Fixed(*low, 2) + " to " + Fixed(*high, 2)) + " px.";
}

void FillResiduals(Dictionary& section, const CameraFit& fit, const ResidualShape& shape) {
  if (shape.numbers == 0) return section.ShowSection("UNSOLVED");
  FillVectors(section, fit, shape);
  FillHistogram(section, shape);
  section.SetValue("SIGMA_PX", Significant(shape.sigma_px, 3));
  section.SetValue("WORST_PX", Significant(shape.worst_px, 3));
  section.SetValue("BEYOND", Significant(100 * shape.beyond_3_ratio, 2));
}

std::string RmsText(const ResidualShape& shape) {
  return shape.numbers > 0 ? Significant(shape.sigma_px * std::sqrt(2.0), 3) : std::string();
}

// In the fold, and in its title for those who do not open it.
void FillAdvice(Dictionary& section, const std::vector<CameraAdvice>& advice) {
  if (advice.empty()) return;
  Dictionary *warned = section.AddSectionDictionary("WARNED"), *box = section.AddSectionDictionary("ADVICE");
  warned->SetValue("COUNT", Count(advice.size(), "warning", "warnings"));
  std::string figures;
  for (const CameraAdvice& one : advice) {
    figures += (figures.empty() ? "" : ", ") + one.figure;
    ShowValue(*box, "ONE", "TEXT", one.text);
  }
  warned->SetValue("FIGURES", figures);
}

void FillSection(Dictionary& section, const ReportInput& input, const CameraReport& camera, bool open) {
  const CameraFit& fit = camera.fit;
  const ResidualShape shape = ShapeOf(fit);
  section.SetValue("CAMERA", fit.camera.str());
  section.SetValue("ANCHOR", AnchorOf(camera));
  section.SetValue("FILE", "cameras/" + camera.document.str() + ".json");
  section.SetValue("SUMMARY", Count(fit.views.size(), "picture", "pictures") + ", " +
                                  Count(CornersOf(fit), "corner", "corners") +
                                  (shape.numbers > 0 ? ", rms " + RmsText(shape) + " px" : ", not solved"));
  if (open) section.ShowSection("OPEN");
  if (const Edge* edge = EdgeOf(input, camera.edge)) {
    Dictionary* from = section.AddSectionDictionary("EDGE");
    from->SetValue("FROM", edge->frame_a.str());
    from->SetValue("TO", edge->frame_b.str());
    from->SetValue("METHOD", MethodText(edge->method));
    FillWorstViews(section, fit, *edge, std::set<Digest>(input.evidence.begin(), input.evidence.end()));
  }
  FillAdvice(section, AdviceOf(fit));
  if (const std::string others = OtherEdgesText(input, camera); !others.empty())
    ShowValue(section, "OTHERS", "TEXT", others);
  FillCoverage(section, fit);
  FillResiduals(section, fit, shape);
  FillStand(section, fit);
  FillUncertainty(section, camera);
  FillIntrinsics(section, camera);
}

void FillRow(Dictionary& row, const CameraReport& camera) {
  const CameraFit& fit = camera.fit;
  const Stand stand = StandOf(fit);
  const ResidualShape shape = ShapeOf(fit);
  row.SetValue("CAMERA", fit.camera.str());
  row.SetValue("ANCHOR", AnchorOf(camera));
  row.SetValue("PICTURES", std::to_string(fit.views.size()));
  row.SetValue("CORNERS", std::to_string(CornersOf(fit)));
  row.SetValue("COVERED", Fixed(100 * CoverageOf(fit).share_ratio, 0));
  row.SetValue("RMS", RmsText(shape));
  row.SetValue("TILT", stand.views > 0 ? Fixed(stand.largest_tilt_rad * kDegPerRad, 0) : "");
  row.SetValue("NEAR", stand.views > 0 ? Significant(stand.nearest_m, 2) : "");
  row.SetValue("FAR", stand.views > 0 ? Significant(stand.farthest_m, 2) : "");
  row.SetValue("SOURCE", SourceText(fit));
  if (fit.source == IntrinsicsSource::kNone) return;
  const double sigma = fit.sigma.empty() ? 0.0 : fit.sigma.front();
  row.SetValue("FX", AsCertainAs(fit.intrinsics.fx_px, sigma));
  row.SetValue("FX_SIGMA", sigma > 0 ? Significant(sigma, 2) : "");
}

// Cameras of the sessions of which nothing was kept.
std::vector<std::string> Missing(const ReportInput& input) {
  std::set<SensorId> shown;
  for (const CameraReport& camera : input.cameras) shown.insert(camera.fit.camera);
  std::vector<std::string> missing;
  for (const auto& [sensor, facts] : input.sensors)
    if (facts.kind == SensorKind::kCamera && !shown.contains(sensor)) missing.push_back(sensor.str());
  return missing;
}

}  // namespace

void FillCameras(Dictionary& page, const ReportInput& input) {
  const std::vector<std::string> missing = Missing(input);
  if (input.cameras.empty() && missing.empty()) return;
  Dictionary* section = page.AddSectionDictionary("CAMERAS_SECTION")->AddIncludeDictionary("CAMERAS");
  section->SetFilename("cameras.tpl");
  if (!input.cameras.empty()) section->ShowSection("TABLE");
  for (std::size_t i = 0; i < input.cameras.size(); ++i) {
    FillRow(*section->AddSectionDictionary("ROW"), input.cameras[i]);
    if (i >= kCamerasMax) continue;
    Dictionary* one = section->AddSectionDictionary("ONE")->AddIncludeDictionary("CAMERA_DETAIL");
    one->SetFilename("camera.tpl");
    FillSection(*one, input, input.cameras[i], input.cameras.size() <= kOpenMax);
  }
  if (missing.empty()) return;
  std::string names = missing.front();
  for (std::size_t i = 1; i < std::min<std::size_t>(missing.size(), 20); ++i) names += ", " + missing[i];
  if (missing.size() > 20) names += " and " + std::to_string(missing.size() - 20) + " more";
  ShowValue(*section, "WITHOUT", "NAMES", names);
}

}  // namespace rigcal::report
