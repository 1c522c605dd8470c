#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// A sigma that is larger by half, and by more than any mount holds still, is worth a better lens model; what adds less
// is in the sigmas, and nobody need act on it.
constexpr double kMatters = 1.5, kMattersMin_m = 5e-5, kMattersMin_rad = 5e-5;

constexpr double kLensNews = 0.1;        // of the tolerance of angles: less is in the poses, and nobody need act on it
constexpr double kBendToldMin_m = 2e-4;  // flatter boards are hardly made
constexpr double kStretchToldMin_ratio = 2e-4;  // no caliper tells less of ten squares

bool Matters(const LensMisfit& misfit) {
  return misfit.sigma_ratio >= kMatters &&
         (misfit.pose_sigma_m >= kMattersMin_m || misfit.pose_sigma_rad >= kMattersMin_rad);
}

std::vector<std::string> NamesOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> names;
  for (const LensMisfit& misfit : misfits) names.push_back(misfit.camera.str());
  return names;
}

// What its lens cannot be described by: a model, or only the numbers that were given for it.
std::string BentModelOf(const LensMisfit& misfit) {
  const bool only_numbers = misfit.trial.given && misfit.trial.proposed == misfit.model;
  return (only_numbers ? "the given " : "") + NameOf(misfit.model);
}

std::string ModelsOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> models;
  for (const LensMisfit& misfit : misfits)
    if (std::find(models.begin(), models.end(), BentModelOf(misfit)) == models.end())
      models.push_back(BentModelOf(misfit));
  return List(models);
}

std::string WhyOf(const std::vector<LensMisfit>& misfits, const LensMisfit& worst) {
  const bool one = misfits.size() == 1;
  return std::string(one ? "the lens of " : "the lenses of ") + List(NamesOf(misfits)) +
         (one ? " bends in a way that " : " bend in ways that ") + ModelsOf(misfits) +
         " cannot: " + TwoDigits(worst.rms_px, "px") + (one ? "" : " of " + worst.camera.str()) +
         ", which makes poses uncertain by " + SigmaText(worst.pose_sigma_m, worst.pose_sigma_rad);
}

std::string LeftOutText(const LensMisfit& misfit) {
  const LensTrial& trial = misfit.trial;
  const auto best = std::find_if(trial.candidates.begin(), trial.candidates.end(),
                                 [&](const LensCandidate& one) { return one.model == trial.proposed; });
  if (best == trial.candidates.end() || !best->left_out_rms_px || !trial.own_left_out_rms_px) return {};
  const std::string own = trial.given ? "the given intrinsics" : NameOf(misfit.model);
  return NameOf(best->model) + " fits pictures of " + misfit.camera.str() + " that were left out to " +
         TwoDigits(*best->left_out_rms_px, "px") + ", " + own + " to " + TwoDigits(*trial.own_left_out_rms_px, "px");
}

// What was found better on pictures that were left out.
std::string ProposalOf(const LensMisfit& misfit) {
  const std::string model = "`model: " + NameOf(*misfit.trial.proposed) + "`";
  const std::string camera = misfit.camera.str(), why = LeftOutText(misfit);
  return (misfit.trial.given ? "leave the intrinsics of " + camera + " out of session.yaml and set " + model
                             : "set " + model + " for " + camera) +
         (why.empty() ? "" : " (" + why + ")");
}

std::string OfThese(const std::vector<LensMisfit>& misfits) {
  const bool one = misfits.size() == 1;
  return std::string(one ? "the pictures of " : "the pictures of any of ") + List(NamesOf(misfits));
}

std::string TriedModels(const LensMisfit& misfit) {
  std::vector<std::string> models;
  for (const LensCandidate& one : misfit.trial.candidates) models.push_back(NameOf(one.model));
  return List(models);
}

// Only seeing more of the picture tells more of a lens that no model describes better.
std::string MoreOfThePicture(const std::vector<LensMisfit>& misfits) {
  const bool all_estimated = std::all_of(misfits.begin(), misfits.end(), [](const LensMisfit& one) {
    return !one.trial.candidates.empty() && !one.trial.given;
  });
  return "capture boards all over the pictures of " + List(NamesOf(misfits)) +
         (all_estimated ? ", as the bend is taken out where corners were seen"
                        : ", and leave out or give a sigma with their intrinsics");
}

// By what was tried: a better model; none is better; nothing was tried (then a richer model where there is one).
std::string CureOf(const std::vector<LensMisfit>& misfits) {
  std::vector<std::string> cures;
  std::vector<LensMisfit> untried, unmatched, others;
  for (const LensMisfit& misfit : misfits) {
    if (misfit.trial.proposed)
      cures.push_back(ProposalOf(misfit));
    else if (!misfit.trial.candidates.empty())
      unmatched.push_back(misfit);
    else
      (misfit.model == CameraModel::kPinholeRadtan ? untried : others).push_back(misfit);
  }
  if (!untried.empty()) cures.push_back("try `model: pinhole_rational` for " + List(NamesOf(untried)));
  if (!others.empty()) cures.push_back(MoreOfThePicture(others));
  if (!unmatched.empty())
    cures.push_back(MoreOfThePicture(unmatched) + " (none of " + TriedModels(unmatched.front()) + " fits " +
                    OfThese(unmatched) + " that were left out better)");
  std::string cure;
  for (const std::string& one : cures) cure += (cure.empty() ? "" : "; ") + one;
  cure.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(cure.front())));
  return cure;
}

// The one that adds most first; at least one.
Finding FindingOf(std::vector<LensMisfit> misfits) {
  std::stable_sort(misfits.begin(), misfits.end(),
                   [](const LensMisfit& x, const LensMisfit& y) { return x.sigma_ratio > y.sigma_ratio; });
  std::vector<SensorId> cameras;
  for (const LensMisfit& misfit : misfits) cameras.push_back(misfit.camera);
  return {WhyOf(misfits, misfits.front()), CureOf(misfits), std::move(cameras)};
}

std::string LensesThatMake(const std::vector<SensorId>& seen_by) {
  if (seen_by.empty()) return "a lens makes";
  return seen_by.size() == 1 ? "the lens of " + seen_by.front().str() + " makes"
                             : "the lenses of " + List(seen_by) + " make";
}

std::string WhereLonger(const PrintStretch& stretch) {
  if (stretch.corners_along == 0) return " along one diagonal than along the other";
  if (stretch.corners_along == stretch.corners_across) return " along one side than along the other";
  return " along the side of " + std::to_string(stretch.corners_along) + " corners than along that of " +
         std::to_string(stretch.corners_across);
}

bool AreAlike(const PrintStretch& x, const PrintStretch& y) {
  constexpr double kAlike_sigmas = 4.0;
  return WhereLonger(x) == WhereLonger(y) &&
         std::abs(x.longer_ratio - y.longer_ratio) <= kAlike_sigmas * std::hypot(x.sigma_ratio, y.sigma_ratio);
}

// One lens or two whose fx is wrong may make several look so, before boards held upright. By how much: by the one that
// tells it best.
std::string StretchText(const std::vector<const PrintStretch*>& alike) {
  std::vector<std::string> boards;
  std::set<SensorId> cameras;
  const PrintStretch* best = alike.front();
  for (const PrintStretch* one : alike) {
    boards.push_back(one->board.str());
    cameras.insert(one->seen_by.begin(), one->seen_by.end());
    if (one->sigma_ratio < best->sigma_ratio) best = one;
  }
  const bool is_one = boards.size() == 1, may_be_lens = is_one || cameras.size() < 3;
  return (is_one ? "the print of board " : "the prints of boards ") + List(boards) + (is_one ? " is" : " are") +
         " longer by " + TwoDigits(100 * best->longer_ratio, "%") + WhereLonger(*best) +
         (may_be_lens ? ", or " + LensesThatMake({cameras.begin(), cameras.end()}) + " it look so; it was"
                      : ", which was") +
         " taken out: measure ten squares each way, and print it anew without scaling";
}

// Boards that one printer printed are stretched alike.
std::vector<std::string> StretchTexts(const std::vector<PrintStretch>& stretches) {
  std::vector<std::vector<const PrintStretch*>> groups;
  for (const PrintStretch& stretch : stretches) {
    if (stretch.longer_ratio < kStretchToldMin_ratio) continue;
    const auto alike = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return AreAlike(*group.front(), stretch); });
    if (alike == groups.end())
      groups.push_back({&stretch});
    else
      alike->push_back(&stretch);
  }
  std::vector<std::string> texts;
  for (const auto& group : groups) texts.push_back(StretchText(group));
  return texts;
}

// The worst and how many besides.
std::string LookScatterText(const std::vector<LookScatter>& cameras) {
  const auto worst = std::max_element(cameras.begin(), cameras.end(), [](const LookScatter& x, const LookScatter& y) {
    return x.sigma_rad < y.sigma_rad;
  });
  const std::size_t others = cameras.size() - 1;
  return "pictures of " + worst->camera.str() +
         (others == 0 ? "" : " and of " + std::to_string(others) + (others == 1 ? " other camera" : " other cameras")) +
         " are off as a whole from capture to capture, by " + TwoDigits(worst->sigma_rad * kDegreesPerRadian, "deg") +
         (others == 0 ? "" : " at worst") +
         ", which is in the sigmas: trigger all cameras at one instant, stand still for each capture, and fasten what "
         "is "
         "loose";
}

// What the session tells: that the board is bent, or that something is.
std::string BendText(const BoardBend& bend) {
  const std::string by = TwoDigits(1e3 * bend.height_m, "mm");
  if (bend.is_the_board)
    return "board " + bend.board.str() + " is bent by " + by + ", which was taken out: a stiffer plate is better";
  return "board " + bend.board.str() + " is bent by " + by + ", or " + LensesThatMake(bend.seen_by) +
         " it look so; it was taken out: lay a straight edge across the board";
}

// By the newest session of each camera.
std::vector<ContradictedLens> NewestContradicted(const std::vector<SessionEstimate>& estimates) {
  std::set<SensorId> asked;
  std::vector<ContradictedLens> newest;
  for (const SessionEstimate& estimate : estimates) {
    if (!estimate.why_not.empty()) continue;
    for (const ContradictedLens& lens : estimate.contradicted_lenses)
      if (!asked.contains(lens.camera)) newest.push_back(lens);
    for (const RefinedPose& pose : estimate.poses) asked.insert(pose.sensor);
  }
  std::stable_sort(newest.begin(), newest.end(),
                   [](const ContradictedLens& x, const ContradictedLens& y) { return x.shift_rad > y.shift_rad; });
  return newest;
}

std::string ShiftText(const ContradictedLens& lens) {
  return TwoDigits(lens.shift_px, "px") + " (" + TwoDigits(lens.shift_rad * kDegreesPerRadian, "deg") + ")";
}

// The camera that `lens` has exchanged its intrinsics with; nullptr: none.
const ContradictedLens* ExchangedWith(const ContradictedLens& lens, const std::vector<ContradictedLens>& all) {
  for (const ContradictedLens& other : all)
    if (other.camera == lens.like && other.like == lens.camera) return &other;
  return nullptr;
}

struct Sentence {
  std::string why, cure;
};
Sentence SentenceOf(const ContradictedLens& lens, const std::vector<ContradictedLens>& all) {
  const std::string camera = lens.camera.str();
  if (ExchangedWith(lens, all) != nullptr) {
    const std::string both = List(std::vector{std::min(lens.camera, lens.like), std::max(lens.camera, lens.like)});
    return {"the intrinsics of " + both +
                " are exchanged: what was given for each fits the lens of the other, and puts "
                "corners " +
                ShiftText(lens) + " elsewhere",
            "exchange the intrinsics of " + both + " in session.yaml"};
  }
  return {"the intrinsics given for " + camera + " do not fit its lens: they put corners " + ShiftText(lens) +
              " elsewhere" + (lens.like.empty() ? "" : "; what was given for " + lens.like.str() + " fits it"),
          "give " + camera + " its own intrinsics in session.yaml, or leave them out, so that they are estimated"};
}

}  // namespace

std::optional<WrongIntrinsics> FindWrongIntrinsics(const std::vector<SessionEstimate>& estimates,
                                                   const Policy& policy) {
  std::vector<ContradictedLens> lenses = NewestContradicted(estimates);
  const auto limit_rad = [&](const ContradictedLens& lens) { return LimitsOf(policy, lens.camera).tolerance.rad; };
  std::erase_if(lenses, [&](const ContradictedLens& lens) { return lens.shift_rad < kLensNews * limit_rad(lens); });
  if (lenses.empty()) return std::nullopt;
  WrongIntrinsics wrong;
  wrong.is_beyond = std::any_of(lenses.begin(), lenses.end(),
                                [&](const ContradictedLens& lens) { return lens.shift_rad > limit_rad(lens); });
  std::string cures;
  for (const ContradictedLens& lens : lenses) {
    wrong.finding.accused.push_back(lens.camera);
    const ContradictedLens* other = ExchangedWith(lens, lenses);
    if (other != nullptr && other < &lens) continue;  // told with the other
    const auto [why, cure] = SentenceOf(lens, lenses);
    wrong.finding.why += (wrong.finding.why.empty() ? "" : "; ") + why;
    cures += (cures.empty() ? "" : "; ") + cure;
  }
  cures.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(cures.front())));
  wrong.finding.what_to_do = cures + ", then push again: `rigcal push FOLDER`";
  wrong.finding.figure = DecidingFigure{"Corners off by the intrinsics of " + lenses.front().camera.str(),
                                        TwoDigits(lenses.front().shift_rad * kDegreesPerRadian, "deg"),
                                        "limit " + TwoDigits(limit_rad(lenses.front()) * kDegreesPerRadian, "deg")};
  return wrong;
}

std::optional<Finding> FindLensMisfits(const std::vector<SessionEstimate>& estimates, bool edges_disagree) {
  std::vector<LensMisfit> misfits = NewestMisfits(estimates);
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
  for (const PupilShift& shift : newest->pupil_shifts)
    remarks.push_back(shift.camera.str() + " sees near boards elsewhere than far ones (its rays meet " +
                      TwoDigits(1e3 * std::abs(shift.shift_m), "mm") + " apart at 45 deg), which was taken out");
  for (const BoardBend& bend : newest->bends)
    if (bend.height_m >= kBendToldMin_m) remarks.push_back(BendText(bend));
  for (std::string& text : StretchTexts(newest->stretches)) remarks.push_back(std::move(text));
  if (!newest->look_scatter.empty()) remarks.push_back(LookScatterText(newest->look_scatter));
  for (const TrackerClock& clock : newest->clocks)
    if (clock.IsOff())
      remarks.push_back("the clock of " + clock.tracker.str() + " is " + Number(1e3 * std::abs(clock.late_s), "ms") +
                        (clock.late_s > 0 ? " late" : " early") + ", which was taken out");
  std::string remark;
  for (const std::string& one : remarks) remark += (remark.empty() ? "" : "; ") + one;
  return remark;
}

std::optional<Finding> FindLensBehind(const std::vector<SessionEstimate>& estimates,
                                      const std::set<SensorId>& accused) {
  std::vector<LensMisfit> misfits = NewestMisfits(estimates);
  std::erase_if(misfits, [&](const LensMisfit& one) { return !accused.contains(one.camera); });
  if (misfits.empty()) return std::nullopt;
  Finding finding = FindingOf(std::move(misfits));
  finding.why = "it may be that " + finding.why;
  return finding;
}

}  // namespace rigcal::fleet
