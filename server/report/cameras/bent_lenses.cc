#include "server/report/cameras/bent_lenses.h"

#include <algorithm>
#include <array>

#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kBentRowsMax = 200;
// Tried on every camera; others have a column where they were tried.
constexpr std::array kTriedOnAll = {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational,
                                    CameraModel::kFisheyeKb4};

std::vector<CameraModel> ColumnsFor(const std::vector<LensMisfit>& lenses) {
  std::vector<CameraModel> columns(kTriedOnAll.begin(), kTriedOnAll.end());
  for (const LensMisfit& lens : lenses)
    for (const LensCandidate& tried : lens.trial.candidates)
      if (std::find(columns.begin(), columns.end(), tried.model) == columns.end()) columns.push_back(tried.model);
  return columns;
}

std::string LeftOutPx(const LensTrial& trial, CameraModel model) {
  const auto tried = std::find_if(trial.candidates.begin(), trial.candidates.end(),
                                  [&](const LensCandidate& one) { return one.model == model; });
  if (tried == trial.candidates.end()) return "not tried";
  if (tried->left_out_rms_px) return Significant(*tried->left_out_rms_px, 2);
  return tried->absurd ? "turns over" : "does not fit";
}

std::string AdviceOn(const LensTrial& trial) {
  if (trial.candidates.empty()) return "not tried";
  if (!trial.proposed) return "none is better";
  return (trial.given ? "calibrate anew as " : "set ") + NameOf(*trial.proposed);
}

void FillBentRow(Dictionary& row, const std::vector<CameraModel>& columns, const LensMisfit& lens) {
  const LensTrial& trial = lens.trial;
  row.SetValue("CAMERA", lens.camera.str());
  row.SetValue("MODEL", NameOf(lens.model) + (trial.given ? ", given" : ""));
  row.SetValue("BEND", Significant(lens.rms_px, 2));
  row.SetValue("SIGMA", SigmaMm(lens.pose_sigma_m) + " / " + SigmaDeg(lens.pose_sigma_rad));
  row.SetValue("OWN", trial.own_left_out_rms_px ? Significant(*trial.own_left_out_rms_px, 2) : "not tried");
  for (const CameraModel model : columns) row.AddSectionDictionary("TRIED")->SetValue("TEXT", LeftOutPx(trial, model));
  ShowValue(row, trial.proposed ? "BETTER" : "PLAIN", "ADVICE", AdviceOn(trial));
}

}  // namespace

void FillBentLenses(Dictionary& section, const std::vector<LensMisfit>& lenses) {
  if (lenses.empty()) return;
  Dictionary* table = section.AddSectionDictionary("BENT");
  const std::vector<CameraModel> columns = ColumnsFor(lenses);
  for (const CameraModel model : columns) table->AddSectionDictionary("HEAD")->SetValue("MODEL", NameOf(model));
  for (std::size_t i = 0; i < std::min(lenses.size(), kBentRowsMax); ++i)
    FillBentRow(*table->AddSectionDictionary("LENS"), columns, lenses[i]);
}

}  // namespace rigcal::report
