#include "server/report/cameras/camera_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/report/cameras/field_map.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::array<int, 5> kLevels = {1, 3, 6, 12, 24};  // corners of a field, at least

// Drawing units per pixel; the picture is kMapWidth wide.
double ScaleOf(const CameraFit& fit) { return fit.width_px > 0 ? kMapWidth / fit.width_px : 1.0; }

// One decimal at most, without a trailing zero: what a path needs.
std::string Short(double value) {
  std::string text = Fixed(value, 1);
  if (text.size() > 2 && text.compare(text.size() - 2, 2, ".0") == 0) text.resize(text.size() - 2);
  return text;
}

std::string Move(double x, double y) { return "M" + Short(x) + " " + Short(y); }
std::string Line(double dx, double dy) { return "l" + Short(dx) + " " + Short(dy); }

struct Vector {
  Eigen::Vector2d at_px, residual_px;
};

// Evenly chosen from `all`, which stays in its order.
std::vector<Vector> Thinned(const std::vector<Vector>& all) {
  if (all.size() <= kVectorsMax) return all;
  std::vector<Vector> chosen;
  for (std::size_t i = 0; i < kVectorsMax; ++i) chosen.push_back(all[i * all.size() / kVectorsMax]);
  return chosen;
}

// Those beyond three sigma apart: they are never left out by chance.
std::pair<std::vector<Vector>, std::vector<Vector>> VectorsOf(const CameraFit& fit, double far_px) {
  std::vector<Vector> usual, far;
  for (const ViewFit& view : fit.views)
    for (std::size_t i = 0; i < view.residual_px.size(); ++i)
      if (view.residual_px[i].allFinite() && view.uv_px[i].allFinite())
        (view.residual_px[i].norm() > far_px ? far : usual).push_back({view.uv_px[i], view.residual_px[i]});
  return {std::move(usual), std::move(far)};
}

std::string PathOf(const std::vector<Vector>& vectors, double scale, double magnified) {
  std::string path;
  for (const Vector& one : vectors)
    path += Move((one.at_px.x() + 0.5) * scale, (one.at_px.y() + 0.5) * scale) +
            Line(one.residual_px.x() * scale * magnified, one.residual_px.y() * scale * magnified);
  return path;
}

std::vector<Vector> MeanVectors(const CameraFit& fit) {
  std::vector<Vector> vectors;
  for (const FieldMean& field : MeansOf(fit)) vectors.push_back({field.at_px, field.mean_px});
  return vectors;
}

std::string LevelText(std::size_t level) {
  const int from = kLevels[level];
  if (level + 1 == kLevels.size()) return std::to_string(from) + " and more";
  const int to = kLevels[level + 1] - 1;
  return from == to ? std::to_string(from) : std::to_string(from) + " to " + std::to_string(to);
}

// Fields of a level as one path of squares.
std::string FieldsOf(const Coverage& coverage, std::size_t level) {
  std::string path;
  for (int row = 0; row < coverage.rows; ++row)
    for (int column = 0; column < coverage.columns; ++column) {
      const int count = coverage.At(column, row);
      const bool above = level + 1 < kLevels.size() && count >= kLevels[level + 1];
      if (count >= kLevels[level] && !above)
        path += "M" + std::to_string(column) + " " + std::to_string(row) + "h1v1h-1z";
    }
  return path;
}

}  // namespace

double NiceBelow(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= value) return step * decade;
  return decade;
}

void FillCoverage(Dictionary& section, const CameraFit& fit) {
  const Coverage coverage = CoverageOf(fit);
  section.SetValue("COLUMNS", std::to_string(coverage.columns));
  section.SetValue("ROWS", std::to_string(coverage.rows));
  section.SetValue("MAP_HEIGHT", MapHeightText(fit.width_px, fit.height_px));
  section.SetValue("COVERED", Fixed(100 * coverage.share_ratio, 0));
  for (std::size_t level = 0; level < kLevels.size(); ++level) {
    const std::string number = std::to_string(level + 1);
    Dictionary* key = section.AddSectionDictionary("HEAT_KEY");
    key->SetValue("LEVEL", number);
    key->SetValue("TEXT", LevelText(level));
    const std::string path = FieldsOf(coverage, level);
    if (path.empty()) continue;
    Dictionary* heat = section.AddSectionDictionary("HEAT");
    heat->SetValue("LEVEL", number);
    heat->SetValue("D", path);
  }
}

void FillVectors(Dictionary& section, const CameraFit& fit, const ResidualShape& shape) {
  constexpr double kUsualLength = 9.0, kMagnifiedMax = 100'000.0;  // of a residual of one sigma, in drawing units
  const double scale = ScaleOf(fit);
  const double magnified =
      shape.sigma_px > 0 ? std::min(kMagnifiedMax, NiceBelow(kUsualLength / (scale * shape.sigma_px))) : 1.0;
  const auto [usual, far] = VectorsOf(fit, 3 * shape.sigma_px);
  const std::vector<Vector> shown = Thinned(usual), shown_far = Thinned(far);
  Dictionary* vectors = section.AddSectionDictionary("VECTORS");
  vectors->SetValue("MAP_HEIGHT", MapHeightText(fit.width_px, fit.height_px));
  vectors->SetValue("MAGNIFIED", Significant(magnified, 1));
  vectors->SetValue("USUAL", PathOf(shown, scale, magnified));
  if (!far.empty()) ShowValue(*vectors, "FAR", "D", PathOf(shown_far, scale, magnified));
  if (const auto means = MeanVectors(fit); !means.empty())
    ShowValue(*vectors, "MEANS", "D", PathOf(means, scale, magnified));
  const std::size_t drawn = shown.size() + shown_far.size(), all = usual.size() + far.size();
  vectors->SetValue("DRAWN", drawn == all ? std::to_string(all) + " corners"
                                          : std::to_string(drawn) + " of " + std::to_string(all) + " corners drawn");
}

namespace {

double PlaceOf(double in_sigmas) { return kMapWidth * (in_sigmas + kReach) / (2 * kReach); }

// Round numbers of pixels, at most four to either side.
void FillTicks(Dictionary& histogram, double sigma_px) {
  if (!(sigma_px > 0.0)) return;
  const double reach_px = kReach * sigma_px;
  double step_px = std::pow(10.0, std::floor(std::log10(reach_px / 5)));
  for (const double factor : {2.0, 2.5, 2.0})
    if (reach_px / step_px >= 5.0) step_px *= factor;
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step_px) + 1e-9)));
  const int most = static_cast<int>(std::floor(reach_px / step_px * 0.96));
  for (int tick = -most; tick <= most; ++tick) {
    Dictionary* mark = histogram.AddSectionDictionary("TICK");
    mark->SetValue("X", Short(PlaceOf(tick * step_px / sigma_px)));
    mark->SetValue("TEXT", Fixed(tick * step_px, decimals));
  }
}

}  // namespace

void FillHistogram(Dictionary& section, const ResidualShape& shape) {
  constexpr double kHeight = 150.0, kFloor = 165.0;
  const double top = std::max(0.42, *std::max_element(shape.density.begin(), shape.density.end()) * 1.05);
  const double width = kMapWidth / kBins;
  std::string bars, curve;
  for (int bin = 0; bin < kBins; ++bin) {
    const double height = shape.density[static_cast<std::size_t>(bin)] / top * kHeight;
    if (height > 0.05)
      bars +=
          Move(bin * width + 0.5, kFloor) + "v-" + Short(height) + "h" + Short(width - 1) + "V" + Short(kFloor) + "z";
  }
  for (int step = 0; step <= 64; ++step) {
    const double t = -kReach + 2 * kReach * step / 64;
    const double height = std::exp(-t * t / 2) / std::sqrt(2 * M_PI) / top * kHeight;
    curve += (step == 0 ? "M" : "L") + Short(kMapWidth * step / 64) + " " + Short(kFloor - height);
  }
  Dictionary* histogram = section.AddSectionDictionary("HISTOGRAM");
  histogram->SetValue("BARS", bars);
  histogram->SetValue("CURVE", curve);
  histogram->SetValue("LIMITS",
                      Move(PlaceOf(-3), 12) + "V" + Short(kFloor) + Move(PlaceOf(3), 12) + "V" + Short(kFloor));
  histogram->SetValue("LOW", Short(PlaceOf(-3)));
  histogram->SetValue("HIGH", Short(PlaceOf(3)));
  FillTicks(*histogram, shape.sigma_px);
}

namespace {

constexpr double kCompass = 100.0, kRim = 88.0;  // middle and radius

int RimOf(double largest_tilt_rad) {
  return std::clamp(static_cast<int>(std::ceil(largest_tilt_rad * kDegPerRad / 15 - 1e-9)), 2, 6) * 15;
}

void FillRings(Dictionary& compass, int rim_deg) {
  for (int ring = 15; ring <= rim_deg; ring += 15) {
    Dictionary* circle = compass.AddSectionDictionary("RING");
    circle->SetValue("R", Short(kRim * ring / rim_deg));
    circle->SetValue("Y", Short(kCompass - kRim * ring / rim_deg + 5));
    circle->SetValue("TEXT", std::to_string(ring));
  }
}

double AxisTop(double farthest_m) {
  const double below = NiceBelow(farthest_m);
  for (const double factor : {1.0, 1.5, 2.0, 2.5, 5.0})
    if (below * factor >= farthest_m) return below * factor;
  return 10 * below;
}

}  // namespace

void FillStand(Dictionary& section, const CameraFit& fit) {
  constexpr double kStrip = 205.0;  // length of the axis of distances
  const Stand stand = StandOf(fit);
  if (stand.views == 0) return;
  Dictionary* drawing = section.AddSectionDictionary("STAND");
  const int rim_deg = RimOf(stand.largest_tilt_rad);
  FillRings(*drawing, rim_deg);
  const double top_m = AxisTop(stand.farthest_m);
  int row = 0;
  for (const ViewFit& view : fit.views) {
    if (view.residual_px.empty()) continue;
    const Eigen::Vector2d place = view.tilt_rad * kDegPerRad / rim_deg * kRim;
    Dictionary* dot = drawing->AddSectionDictionary("DOT");
    dot->SetValue("X", Short(kCompass + place.x()));
    dot->SetValue("Y", Short(kCompass + place.y()));
    dot->SetValue("ALONG", Short(10 + kStrip * view.distance_m / top_m));
    dot->SetValue("ROW", std::to_string(8 + 6 * (row++ % 4)));
    dot->SetValue("TITLE", view.capture.str() + ": tilted " + Fixed(view.tilt_rad.norm() * kDegPerRad, 0) + " deg, " +
                               Significant(view.distance_m, 3) + " m away");
  }
  for (const double part : {0.0, 0.5, 1.0}) {
    Dictionary* mark = drawing->AddSectionDictionary("MARK");
    mark->SetValue("X", Short(10 + kStrip * part));
    mark->SetValue("TEXT", part == 0.0 ? "0" : Significant(top_m * part, 2) + " m");
  }
}

}  // namespace rigcal::report
