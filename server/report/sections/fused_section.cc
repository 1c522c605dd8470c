#include "server/report/sections/fused_section.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "server/report/cameras/bent_lenses.h"
#include "server/report/text/changes.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kFusedRowsMax = 200, kFusedNamesMax = 10;

struct Moved {
  const SensorPose* pose;
  SensorMove by;  // from the pairs' pose, in their sigmas
};

std::vector<Moved> MostMovedFirst(const formats::RevisionInput& revision) {
  std::vector<Moved> moved;
  for (const SensorPose& pose : revision.solution.poses) {
    if (!pose.fused) continue;
    SensorPose before = pose, now = pose;
    before.T_ref_sensor = pose.fused->T_ref_sensor_by_pairs;
    before.covariance = pose.fused->covariance_by_pairs;
    now.covariance.setZero();
    moved.push_back({&pose, MoveOf(before, now)});
  }
  std::stable_sort(moved.begin(), moved.end(),
                   [](const Moved& x, const Moved& y) { return x.by.in_sigmas > y.by.in_sigmas; });
  if (moved.size() > kFusedRowsMax) moved.resize(kFusedRowsMax);
  return moved;
}

double LargestSigma_m(const Matrix6d& covariance) { return std::sqrt(covariance.diagonal().head<3>().maxCoeff()); }

std::string ScatterText(const FusedPose& fused) {
  if (fused.sessions < 2 && !fused.pooled_scatter) return "one visit";
  if (fused.visit_sigma_m <= 0 && fused.visit_sigma_rad <= 0) return "within \xCF\x83";
  return SigmaMm(fused.visit_sigma_m) + " / " + SigmaDeg(fused.visit_sigma_rad) +
         (fused.pooled_scatter
              ? ", with " + Count(static_cast<std::size_t>(fused.pooled_scatter->robots), "robot", "robots")
              : "");
}

// A place that goes on by as much in a month as it is known to, or more, does not stay.
std::string VisitsText(const SensorPose& pose) {
  const double month = std::sqrt(30.0), walk_m = month * pose.fused->walk_m_per_sqrt_day,
               walk_rad = month * pose.fused->walk_rad_per_sqrt_day;
  const double sigma_rad = std::sqrt(pose.covariance.diagonal().tail<3>().maxCoeff());
  if (walk_m < LargestSigma_m(pose.covariance) && walk_rad < sigma_rad) return ScatterText(*pose.fused);
  return ScatterText(*pose.fused) + "; goes on by some " + SigmaMm(walk_m) + " / " + SigmaDeg(walk_rad) + " a month";
}

// Of one visit nothing is to be told of visits, unless other robots tell it.
bool TellsVisits(const formats::RevisionInput& revision) {
  const auto& poses = revision.solution.poses;
  return revision.solution.fused.sessions.size() > 1 ||
         std::any_of(poses.begin(), poses.end(),
                     [](const SensorPose& pose) { return pose.fused && pose.fused->pooled_scatter; });
}

void FillRow(Dictionary& row, const Moved& moved, bool visits) {
  const FusedPose& fused = *moved.pose->fused;
  row.SetValue("NAME", moved.pose->sensor.str());
  row.SetValue("MM", Mm(moved.by.distance_m));
  row.SetValue("DEG", Deg(moved.by.angle_rad));
  row.SetValue("SIGMAS", SigmasText(moved.by.in_sigmas));
  row.SetValue("CLASS", SigmasClass(moved.by.in_sigmas));
  row.SetValue("BEFORE", SigmaMm(LargestSigma_m(fused.covariance_by_pairs)));
  row.SetValue("NOW", SigmaMm(LargestSigma_m(moved.pose->covariance)));
  if (visits) ShowValue(row, "VISITS", "TEXT", VisitsText(*moved.pose));
}

std::string CapturesText(const std::vector<std::string>& names) {
  std::string text = names.size() == 1 ? "capture " : "captures ";
  for (std::size_t i = 0; i < std::min(names.size(), kFusedNamesMax); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return text +
         (names.size() > kFusedNamesMax ? " and " + std::to_string(names.size() - kFusedNamesMax) + " more" : "");
}

// "front_right in capture 007 contradicts all that was seen besides: ..."; where only two sensors saw the place, either
// may be wrong.
std::string HeldBackText(const FusedSessions::HeldBack& look, const std::vector<std::string>& names) {
  const std::string sensor = look.sensor.str(), in_captures = sensor + " in " + CapturesText(names);
  if (look.why == WhyHeldBack::kPlaceUnknown)
    return in_captures + " took no part: nothing tells where the board stood that it saw.";
  if (look.why == WhyHeldBack::kBehindTheCamera)
    return in_captures + " took no part: by all else its board was behind it.";
  return in_captures + (names.size() == 1 ? " contradicts " : " contradict ") +
         (look.against.empty()
              ? "all that was seen besides, as a picture of another instant does; it"
              : look.against.str() + ", and either may be of another instant; what " + sensor + " saw") +
         " counts for next to nothing.";
}

void FillHeldBack(Dictionary& section, const FusedSessions& fused) {
  using Kind = std::tuple<SensorId, SensorId, WhyHeldBack>;
  std::map<Kind, std::pair<FusedSessions::HeldBack, std::vector<std::string>>> kinds;
  for (const FusedSessions::HeldBack& look : fused.held_back) {
    auto& [first, names] =
        kinds.try_emplace({look.sensor, look.against, look.why}, look, std::vector<std::string>()).first->second;
    if (std::find(names.begin(), names.end(), look.capture.str()) == names.end()) names.push_back(look.capture.str());
  }
  for (const auto& [kind, told] : kinds) ShowValue(section, "HELD_BACK", "TEXT", HeldBackText(told.first, told.second));
}

// "Of the newest session capture 12 does most: without it the pose of front_right would be 1.4 sigma elsewhere."
std::string InfluentialText(const FusedSessions::Influential& most) {
  std::vector<std::string> names;
  for (const CaptureId& capture : most.captures) names.push_back(capture.str());
  const bool one = names.size() == 1;
  return "Of the newest session " + CapturesText(names) + (one ? " does" : " do") + " most: without " +
         (one ? "it" : "them") + " the pose of " + most.sensor.str() + " would be " + SigmasText(most.sigmas) +
         " \xCF\x83 elsewhere.";
}

std::string Ms(double seconds) { return Fixed(1e3 * seconds, 1) + " ms"; }

// "The clock of body is 12.3 ms late (sigma 0.4 ms), which was taken out ..."; where the body did not move nothing is
// known.
std::string ClockText(const TrackerClock& clock) {
  if (clock.captures > 0 && clock.sigma_s >= std::max(clock.given_sigma_s, std::abs(clock.late_s)))
    return "The clock of " + clock.tracker.str() +
           " seems to be off by more than its path, or the clock_sigma_s that was given, allows: synchronise it and "
           "capture again.";
  if (!clock.IsKnown())
    return "Of the clock of " + clock.tracker.str() + " the session says nothing: its body " +
           (clock.captures == 0 ? "stood still at all captures." : "moved too little at captures.");
  return "The clock of " + clock.tracker.str() + " is " + Ms(std::abs(clock.late_s)) +
         (clock.late_s < 0 ? " early" : " late") + " (\xCF\x83 " + Ms(clock.sigma_s) + "), by " +
         Count(static_cast<std::size_t>(clock.captures), "capture", "captures") +
         " at which its body moved; that was taken out of the poses.";
}

}  // namespace

void FillFused(Dictionary& page, const formats::RevisionInput& revision) {
  const std::vector<Moved> rows = MostMovedFirst(revision);
  if (rows.empty()) return;
  Dictionary* section = page.AddSectionDictionary("FUSED_SECTION")->AddIncludeDictionary("FUSED");
  section->SetFilename("fused.tpl");
  const std::size_t sessions = revision.solution.fused.sessions.size();
  section->SetValue("SUMMARY", "All that the sensors saw in " + Count(sessions, "session", "sessions") +
                                   ", as one estimate" + (sessions > 1 ? " per session." : "."));
  const bool visits = TellsVisits(revision);
  if (visits) section->ShowSection("VISITS_HEAD");
  if (visits) section->ShowSection("VISITS_NOTE");
  FillHeldBack(*section, revision.solution.fused);
  if (const auto& most = revision.solution.fused.influential)
    ShowValue(*section, "INFLUENTIAL", "TEXT", InfluentialText(*most));
  for (const auto& [session, clock] : revision.solution.fused.clocks)
    ShowValue(*section, "CLOCK", "TEXT", ClockText(clock));
  FillBentLenses(*section, revision.solution.fused.lenses);
  for (const Moved& moved : rows) FillRow(*section->AddSectionDictionary("SENSOR"), moved, visits);
}

}  // namespace rigcal::report
