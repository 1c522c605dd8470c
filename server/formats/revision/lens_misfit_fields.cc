#include "server/formats/revision/lens_misfit_fields.h"

#include <climits>

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kBentLensesMax = 10'000, kLensModelsMax = 100;

CameraModel ReadLensModel(const JsonField& field) {
  const auto known = CameraModelOf(field.Text());
  if (known) return *known;
  field.Refuse(known.error().what);
  return {};
}

void WriteLeftOut(JsonWriter& out, const std::optional<double>& rms_px) {
  if (rms_px)
    out.Number("left_out_rms_px", *rms_px);
  else
    out.Null("left_out_rms_px");
}

std::optional<double> ReadLeftOut(const JsonField& parent) {
  const JsonField field = parent.At("left_out_rms_px");
  if (field.IsNull()) return std::nullopt;
  return field.Number();
}

void WriteTrial(JsonWriter& out, const LensTrial& trial) {
  if (trial.candidates.empty()) return;
  out.Object("trial", [&] {
    out.List("candidates", [&] {
      for (const LensCandidate& candidate : trial.candidates)
        out.Object([&] {
          out.Flag("absurd", candidate.absurd);
          WriteLeftOut(out, candidate.left_out_rms_px);
          out.Text("model", NameOf(candidate.model));
        });
    });
    out.Integer("captures", trial.captures);
    out.Flag("given", trial.given);
    WriteLeftOut(out, trial.own_left_out_rms_px);
    if (trial.proposed) out.Text("proposed", NameOf(*trial.proposed));
  });
}

LensTrial ReadTrial(const JsonField& misfit) {
  LensTrial trial;
  const auto field = misfit.Find("trial");
  if (!field) return trial;
  trial.own_left_out_rms_px = ReadLeftOut(*field);
  trial.given = field->At("given").Flag();
  trial.captures = static_cast<int>(field->At("captures").Integer(0, INT_MAX));
  for (const JsonField& item : field->At("candidates").Items(kLensModelsMax))
    trial.candidates.push_back({ReadLensModel(item.At("model")), ReadLeftOut(item), item.At("absurd").Flag()});
  if (const auto proposed = field->Find("proposed")) trial.proposed = ReadLensModel(*proposed);
  return trial;
}

LensMisfit ReadMisfit(const JsonField& field) {
  LensMisfit misfit;
  misfit.camera = ReadId<SensorId>(field.At("camera"));
  misfit.model = ReadLensModel(field.At("model"));
  misfit.rms_px = field.At("rms_px").Number();
  misfit.evidence = field.At("evidence").Number();
  misfit.pose_sigma_m = field.At("pose_sigma_m").Number();
  misfit.pose_sigma_rad = field.At("pose_sigma_rad").Number();
  misfit.sigma_ratio = field.At("sigma_ratio").Number();
  misfit.trial = ReadTrial(field);
  return misfit;
}

}  // namespace

void WriteMisfits(JsonWriter& out, std::string_view key, const std::vector<LensMisfit>& misfits) {
  out.List(key, [&] {
    for (const LensMisfit& misfit : misfits)
      out.Object([&] {
        out.Text("camera", misfit.camera.str());
        out.Number("evidence", misfit.evidence);
        out.Text("model", NameOf(misfit.model));
        out.Number("pose_sigma_m", misfit.pose_sigma_m);
        out.Number("pose_sigma_rad", misfit.pose_sigma_rad);
        out.Number("rms_px", misfit.rms_px);
        out.Number("sigma_ratio", misfit.sigma_ratio);
        WriteTrial(out, misfit.trial);
      });
  });
}

std::vector<LensMisfit> ReadMisfits(const JsonField& field) {
  std::vector<LensMisfit> misfits;
  for (const JsonField& item : field.Items(kBentLensesMax)) misfits.push_back(ReadMisfit(item));
  return misfits;
}

void WritePupilShifts(JsonWriter& out, const std::vector<PupilShift>& shifts) {
  if (shifts.empty()) return;
  out.List("pupil_shifts", [&] {
    for (const PupilShift& shift : shifts)
      out.Object([&] {
        out.Text("camera", shift.camera.str());
        out.Number("shift_m", shift.shift_m);
        out.Number("sigma_m", shift.sigma_m);
      });
  });
}

PupilShift ReadPupilShift(const JsonField& field) {
  return {ReadId<SensorId>(field.At("camera")), field.At("shift_m").Number(), field.At("sigma_m").Number()};
}

}  // namespace rigcal::formats
