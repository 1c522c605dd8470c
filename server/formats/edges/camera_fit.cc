#include "server/formats/edges/camera_fit.h"

#include <cmath>

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

const char* NameOfSource(IntrinsicsSource source) {
  if (source == IntrinsicsSource::kGiven) return "given";
  return source == IntrinsicsSource::kRefined ? "refined" : "estimated";
}

constexpr std::size_t kViewsMax = 100'000, kNumbersMax = 1'000'000, kDistortionMax = 16;
constexpr std::int64_t kSizeMax_px = 1'000'000;

double Rounded(double value, double steps) { return std::round(value * steps) / steps; }

void WritePairs(JsonWriter& out, const char* key, const std::vector<Eigen::Vector2d>& pairs, double steps) {
  out.List(key, [&] {
    for (const Eigen::Vector2d& pair : pairs)
      for (const double value : pair) out.Number(Rounded(value, steps));
  });
}

void WriteNumbers(JsonWriter& out, const char* key, const std::vector<double>& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WriteRows(JsonWriter& out, const char* key, const Eigen::MatrixXd& matrix) {
  out.List(key, [&] {
    for (const auto& row : matrix.rowwise())
      out.List([&] {
        for (const double value : row) out.Number(value);
      });
  });
}

void WriteView(JsonWriter& out, const ViewFit& view) {
  out.Text("capture", view.capture.str());
  out.Number("distance_m", view.distance_m);
  WritePairs(out, "residual_px", view.residual_px, 1e3);
  WritePairs(out, "tilt_rad", {view.tilt_rad}, 1e6);
  WritePairs(out, "uv_px", view.uv_px, 1e2);
}

void WriteIntrinsics(JsonWriter& out, const CameraFit& fit) {
  if (fit.source == IntrinsicsSource::kNone) return out.Null("intrinsics");
  out.Object("intrinsics", [&] {
    WriteLowerTriangle(out, "covariance", fit.covariance);
    WriteLensMembers(out, fit.intrinsics);
    WriteRows(out, "implied_motion", fit.implied_motion);
    WriteNumbers(out, "sigma", fit.sigma);
    out.Flag("sigma_by_jackknife", fit.sigma_by_jackknife);
    out.Text("source", NameOfSource(fit.source));
  });
}

std::vector<double> ReadNumbers(const JsonField& field, std::size_t count_max) {
  std::vector<double> values;
  for (const JsonField& item : field.Items(count_max)) values.push_back(item.Number());
  return values;
}

std::vector<Eigen::Vector2d> ReadPairs(const JsonField& field) {
  const std::vector<double> values = ReadNumbers(field, kNumbersMax);
  if (values.size() % 2 != 0) field.Refuse("must have an even number of values");
  std::vector<Eigen::Vector2d> pairs;
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) pairs.emplace_back(values[i], values[i + 1]);
  return pairs;
}

ViewFit ReadView(const JsonField& field) {
  ViewFit view;
  view.capture = ReadId<CaptureId>(field.At("capture"));
  view.distance_m = field.At("distance_m").Number();
  view.residual_px = ReadPairs(field.At("residual_px"));
  view.uv_px = ReadPairs(field.At("uv_px"));
  field.At("tilt_rad").Numbers(view.tilt_rad.data(), 2);
  if (!view.residual_px.empty() && view.residual_px.size() != view.uv_px.size())
    field.Refuse("must have a residual for every corner, or none");
  return view;
}

// As documents of before do not have them.
void ReadCovariance(const JsonField& field, CameraFit& fit) {
  const auto covariance = field.Find("covariance"), motion = field.Find("implied_motion");
  if (!covariance || !motion || covariance->Items(kDistortionMax + 4).empty()) return;
  const std::size_t count = 4 + fit.intrinsics.distortion.size();
  const auto columns = static_cast<Eigen::Index>(count);
  const std::vector<JsonField> rows = motion->Items(6);
  if (covariance->Items(kDistortionMax + 4).size() != count)
    return covariance->Refuse("must have a row for every value");
  if (rows.size() != 6) return motion->Refuse("must have 6 rows");
  fit.covariance = ReadLowerTriangle(*covariance);
  fit.implied_motion = Eigen::MatrixXd::Zero(6, columns);
  Eigen::VectorXd values(columns);
  for (Eigen::Index row = 0; row < 6; ++row) {
    rows[static_cast<std::size_t>(row)].Numbers(values.data(), count);
    fit.implied_motion.row(row) = values.transpose();
  }
}

void ReadIntrinsics(const JsonField& field, CameraFit& fit) {
  const std::string source = field.At("source").Text();
  if (source != "given" && source != "refined" && source != "estimated")
    field.At("source").Refuse("must be \"given\", \"refined\" or \"estimated\"");
  fit.source = source == "given"     ? IntrinsicsSource::kGiven
               : source == "refined" ? IntrinsicsSource::kRefined
                                     : IntrinsicsSource::kEstimated;
  fit.intrinsics = ReadLensMembers(field);
  fit.sigma = ReadNumbers(field.At("sigma"), kDistortionMax + 4);
  if (!fit.sigma.empty() && fit.sigma.size() != 4 + fit.intrinsics.distortion.size())
    field.Refuse("must have a sigma for every value, or none");
  fit.sigma_by_jackknife = field.At("sigma_by_jackknife").Flag();
  ReadCovariance(field, fit);
}

}  // namespace

void WriteLensMembers(JsonWriter& out, const CameraIntrinsics& values) {
  out.Text("model", NameOf(values.model));
  WriteNumbers(out, "distortion", values.distortion);
  WriteNumbers(out, "f_c_px", {values.fx_px, values.fy_px, values.cx_px, values.cy_px});
}

CameraIntrinsics ReadLensMembers(const JsonField& field) {
  CameraIntrinsics values;
  values.model = ReadNamed(field.At("model"), CameraModelOf, values.model);
  double f_c_px[4] = {};
  field.At("f_c_px").Numbers(f_c_px, 4);
  values.fx_px = f_c_px[0], values.fy_px = f_c_px[1], values.cx_px = f_c_px[2], values.cy_px = f_c_px[3];
  values.distortion = ReadNumbers(field.At("distortion"), kDistortionMax);
  if (values.distortion.size() != DistortionCount(values.model)) field.Refuse("has the wrong number of distortions");
  return values;
}

void WriteCameraFitMembers(JsonWriter& out, const CameraFit& fit) {
  out.Text("camera", fit.camera.str());
  out.Integer("format", 1);
  out.Integer("height_px", fit.height_px);
  WriteIntrinsics(out, fit);
  out.List("views", [&] {
    for (const ViewFit& view : fit.views) out.Object([&] { WriteView(out, view); });
  });
  out.Integer("width_px", fit.width_px);
}

std::string WriteCameraFit(const CameraFit& fit) {
  return WriteObject([&](JsonWriter& out) { WriteCameraFitMembers(out, fit); });
}

CameraFit ReadCameraFitMembers(const JsonField& root) {
  CameraFit fit;
  (void)root.At("format").Integer(1, 1);
  fit.camera = ReadId<SensorId>(root.At("camera"));
  fit.width_px = static_cast<int>(root.At("width_px").Integer(0, kSizeMax_px));
  fit.height_px = static_cast<int>(root.At("height_px").Integer(0, kSizeMax_px));
  if (const auto intrinsics = root.Find("intrinsics")) ReadIntrinsics(*intrinsics, fit);
  for (const JsonField& view : root.At("views").Items(kViewsMax)) fit.views.push_back(ReadView(view));
  return fit;
}

Result<CameraFit> ReadCameraFit(std::string_view text) {
  RIGCAL_ASSIGN(JsonDocument document,
                JsonDocument::Parse(text, {"camera fit", "Push the session again.", kCameraFitBytesMax}));
  CameraFit fit = ReadCameraFitMembers(document.Root());
  RIGCAL_TRY(document.status());
  return fit;
}

}  // namespace rigcal::formats
