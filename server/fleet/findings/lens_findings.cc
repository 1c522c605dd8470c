#include <algorithm>
#include <cmath>
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// A sigma that is larger by half, and by more than any mount holds still, is worth a better lens model; what adds less
// is in the sigmas, and nobody need act on it.
constexpr double kMatters = 1.5, kMattersMin_m = 5e-5, kMattersMin_rad = 5e-5;

constexpr double kBendToldMin_m = 2e-4;  // flatter boards are hardly made

bool Matters(const LensMisfit& misfit) {
  return misfit.sigma_ratio >= kMatters &&
         (misfit.pose_sigma_m >= kMattersMin_m || misfit.pose_sigma_rad >= kMattersMin_rad);
}

// Of each camera what the newest session says in which it took part.
std::vector<LensMisfit> NewestOf(const std::vector<SessionEstimate>& estimates) {
  std::vector<LensMisfit> newest;
  std::set<SensorId> judged;
  for (const SessionEstimate& estimate : estimates) {
    if (!estimate.why_not.empty()) continue;
    for (const LensMisfit& misfit : estimate.misfits)
      if (!judged.contains(misfit.camera)) newest.push_back(misfit);
    for (const RefinedPose& pose : estimate.poses) judged.insert(pose.sensor);
  }
  return newest;
}

std::vector<std::string> NamesOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> names;
  for (const LensMisfit& misfit : misfits) names.push_back(misfit.camera.str());
  return names;
}

std::string ModelsOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> models;
  for (const LensMisfit& misfit : misfits)
    if (std::find(models.begin(), models.end(), NameOf(misfit.model)) == models.end())
      models.push_back(NameOf(misfit.model));
  return List(models);
}

std::string WhyOf(const std::vector<LensMisfit>& misfits, const LensMisfit& worst) {
  const bool one = misfits.size() == 1;
  return std::string(one ? "the lens of " : "the lenses of ") + List(NamesOf(misfits)) +
         (one ? " bends in a way that " : " bend in ways that ") + ModelsOf(misfits) +
         " cannot: " + TwoDigits(worst.rms_px, "px") + (one ? "" : " of " + worst.camera.str()) +
         ", which makes poses uncertain by " + SigmaText(worst.pose_sigma_m, worst.pose_sigma_rad);
}

// A richer model where there is one; else only seeing more of the picture tells more of the lens.
std::string CureOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> radtan, others;
  for (const LensMisfit& misfit : misfits)
    (misfit.model == CameraModel::kPinholeRadtan ? radtan : others).push_back(misfit.camera.str());
  std::string cure;
  if (!radtan.empty()) cure = "Try `model: pinhole_rational` for " + List(radtan);
  if (others.empty()) return cure;
  return cure + (cure.empty() ? "Capture" : "; capture") + " boards all over the pictures of " + List(others) +
         ", and leave out or give a sigma with their intrinsics";
}

// The one that adds most first; at least one.
Finding FindingOf(std::vector<LensMisfit> misfits) {
  std::stable_sort(misfits.begin(), misfits.end(),
                   [](const LensMisfit& x, const LensMisfit& y) { return x.sigma_ratio > y.sigma_ratio; });
  return {WhyOf(misfits, misfits.front()), CureOf(misfits)};
}

// What the session tells: that the board is bent, or that something is.
std::string BendText(const BoardBend& bend) {
  const std::string by = TwoDigits(1e3 * bend.height_m, "mm");
  if (bend.is_the_board) return "board " + bend.board.str() + " is bent by " + by + ", which was taken out: a stiffer plate is better";
  const std::string lens = bend.seen_by.empty()       ? "a lens makes"
                           : bend.seen_by.size() == 1 ? "the lens of " + bend.seen_by.front().str() + " makes"
                                                      : "the lenses of " + List(bend.seen_by) + " make";
  return "board " + bend.board.str() + " is bent by " + by + ", or " + lens +
         " it look so; it was taken out: lay a straight edge across the board";
}

}  // namespace

std::optional<Finding> FindLensMisfits(const std::vector<SessionEstimate>& estimates, bool edges_disagree) {
  std::vector<LensMisfit> misfits = NewestOf(estimates);
  if (!edges_disagree) std::erase_if(misfits, [](const LensMisfit& one) { return !Matters(one); });
  if (misfits.empty()) return std::nullopt;
  Finding finding = FindingOf(std::move(misfits));
  if (edges_disagree) finding.why = "pairs of sensors disagree because " + finding.why;
  return finding;
}

std::string TakenOutRemark(const std::vector<SessionEstimate>& estimates) {
  const auto newest = std::find_if(estimates.begin(), estimates.end(),
                                   [](const SessionEstimate& estimate) { return estimate.why_not.empty(); });
  if (newest == estimates.end()) return {};
  std::vector<std::string> remarks;
  for (const SlantBias& slant : newest->slants)
    remarks.push_back(slant.lidar.str() + " measures " + TwoDigits(1e3 * std::abs(slant.too_long_m), "mm") +
                      (slant.too_long_m > 0 ? " too long" : " too short") +
                      " where its beam meets a surface at 60 deg, which was taken out");
  for (const BoardBend& bend : newest->bends)
    if (bend.height_m >= kBendToldMin_m) remarks.push_back(BendText(bend));
  for (const TrackerClock& clock : newest->clocks)
    if (clock.IsOff())
      remarks.push_back("the clock of " + clock.tracker.str() + " is " + Number(1e3 * std::abs(clock.late_s), "ms") +
                        (clock.late_s > 0 ? " late" : " early") + ", which was taken out");
  std::string remark;
  for (const std::string& one : remarks) remark += (remark.empty() ? "" : "; ") + one;
  return remark;
}

std::optional<Finding> FindLensBehind(const std::vector<SessionEstimate>& estimates, const std::set<SensorId>& accused) {
  std::vector<LensMisfit> misfits = NewestOf(estimates);
  std::erase_if(misfits, [&](const LensMisfit& one) { return !accused.contains(one.camera); });
  if (misfits.empty()) return std::nullopt;
  Finding finding = FindingOf(std::move(misfits));
  finding.why = "it may be that " + finding.why;
  return finding;
}

}  // namespace rigcal::fleet
