#include "server/calib/joint/estimate_session.h"

#include <algorithm>
#include <exception>
#include <map>
#include <set>
#include <tuple>

#include "server/base/process/parallel_for.h"
#include "server/calib/camera/lens_trial.h"
#include "server/calib/joint/misfit/board_or_lens.h"
#include "server/calib/joint/misfit/contradicted_pairs.h"
#include "server/calib/joint/misfit/instrument_effects.h"
#include "server/calib/joint/misfit/lost_sight.h"
#include "server/calib/joint/misfit/pose_clock.h"
#include "server/calib/joint/refine/lens_numbers.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kHeldBackBelow = 0.5;  // of a look's weight

SessionEstimate Refused(const SessionViews& views, Diagnosis why_not) {
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.why_not.push_back(std::move(why_not));
  return estimate;
}
SessionEstimate Refused(const SessionViews& views, const std::string& code, const Error& error) {
  return Refused(views, Diagnosis{code, error.what, error.cure});
}

// Per place.
std::vector<std::set<SensorId>> SensorsThatSaw(const SessionProblem& problem) {
  std::vector<std::set<SensorId>> sensors(problem.capture_of_place.size());
  ForEachLook(problem, [&](const Where& look) {
    sensors[static_cast<std::size_t>(look.place)].insert(problem.sensors[static_cast<std::size_t>(look.sensor)]);
  });
  return sensors;
}

template <typename Looks>
void AddHeldBack(const SessionProblem& problem, const std::vector<std::set<SensorId>>& saw, const Looks& looks,
                 const std::vector<double>& weights, std::vector<HeldBackLook>& held_back) {
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (weights[i] >= kHeldBackBelow) continue;
    HeldBackLook look{problem.sensors[static_cast<std::size_t>(looks[i].sensor)], CaptureAt(problem, looks[i].place)};
    const std::set<SensorId>& all = saw[static_cast<std::size_t>(looks[i].place)];
    if (all.size() == 2) look.against = *all.begin() == look.sensor ? *all.rbegin() : *all.begin();
    held_back.push_back(std::move(look));
  }
}

// Rows of the poses in the order of `sensors`, indices of the problem.
Eigen::MatrixXd InOrder(const Eigen::MatrixXd& joint, const std::vector<int>& row_of_sensor,
                        const std::vector<int>& sensors) {
  std::vector<int> rows;
  for (const int sensor : sensors)
    if (const int row = row_of_sensor[static_cast<std::size_t>(sensor)]; row != kNone)
      for (int i = 0; i < 6; ++i) rows.push_back(row + i);
  return joint(rows, rows);
}

// By name; of a sensor that moved, which is in the problem several times, the one that was seen last.
std::map<SensorId, int> LastOfEach(const SessionProblem& problem) {
  std::vector<int> place(problem.sensors.size(), kNone);
  ForEachLook(problem, [&](const Where& look) {
    int& last = place[static_cast<std::size_t>(look.sensor)];
    last = std::max(last, look.place);
  });
  std::map<SensorId, int> last;
  for (int s = 0; s < static_cast<int>(problem.sensors.size()); ++s) {
    const auto [known, is_new] = last.try_emplace(problem.sensors[static_cast<std::size_t>(s)], s);
    if (!is_new && place[static_cast<std::size_t>(s)] > place[static_cast<std::size_t>(known->second)])
      known->second = s;
  }
  last[problem.sensors[static_cast<std::size_t>(problem.reference)]] = problem.reference;
  return last;
}

// Of two covariances of the same unknowns, either of which may be empty.
Eigen::MatrixXd Together(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.size() == 0) return b;
  return b.size() == 0 ? a : Eigen::MatrixXd(a + b);
}

void AddPoses(const Explained& explained, SessionEstimate& estimate) {
  const SessionProblem& problem = explained.start.problem;
  const Eigen::MatrixXd by_fields = CovarianceByFields(explained.misfits);
  const Eigen::MatrixXd beside = Together(by_fields, CovarianceByInstruments(explained));
  PoseCovariance covariance = CovarianceOfPoses(explained.refined, beside);
  estimate.clocks = ClocksTold(problem, explained.refined, covariance.spread_ratio, beside);
  const Eigen::MatrixXd by_clocks = CovarianceByClocks(explained.refined, estimate.clocks);
  const Eigen::MatrixXd by_moves = CovarianceByMovesLeft(explained.refined);
  if (by_clocks.size() + by_moves.size() > 0)
    covariance = CovarianceOfPoses(explained.refined, Together(beside, by_clocks), by_moves);
  std::vector<int> sensors;
  for (const auto& [id, s] : LastOfEach(problem)) {
    estimate.poses.push_back({id, explained.refined.state.T_ref_sensor[static_cast<std::size_t>(s)],
                              covariance.dof[static_cast<std::size_t>(s)],
                              SmallestMoveTold(problem, explained.refined, s)});
    sensors.push_back(s);
  }
  estimate.covariance = InOrder(covariance.joint, covariance.row_of_sensor, sensors);
  if (!covariance.common.isZero(0)) estimate.common = InOrder(covariance.common, covariance.row_of_sensor, sensors);
  if (explained.misfits.any())
    estimate.misfits = MisfitsTold(problem, explained.refined, explained.misfits, covariance);
  estimate.slants = SlantsTold(problem, explained.refined, by_fields);
  estimate.bends = BendsTold(problem, explained.refined, by_fields);
  AttributeBends(explained, estimate.bends);
}

void AddHeldBack(const Explained& explained, SessionEstimate& estimate) {
  const SessionProblem& problem = explained.start.problem;
  const LookWeights& weights = explained.refined.weights;
  const auto saw = SensorsThatSaw(problem);
  AddHeldBack(problem, saw, problem.corners, weights.corners, estimate.held_back);
  AddHeldBack(problem, saw, problem.plates, weights.plates, estimate.held_back);
  AddHeldBack(problem, saw, problem.poses, weights.poses, estimate.held_back);
  std::sort(estimate.held_back.begin(), estimate.held_back.end(), [](const HeldBackLook& x, const HeldBackLook& y) {
    return std::tie(x.sensor, x.capture) < std::tie(y.sensor, y.capture);
  });
}

// Captures whose look by the camera contradicts all others have none.
std::map<CaptureId, int> GroupsOfLooks(const Explained& explained, const SensorId& camera,
                                       const std::vector<HeldBackLook>& held_back) {
  std::map<CaptureId, int> groups;
  const std::vector<int>& group_of_place = explained.refined.groups.group_of_place;
  for (std::size_t place = 0; place < group_of_place.size(); ++place)
    groups.emplace(CaptureAt(explained.start.problem, static_cast<int>(place)), group_of_place[place]);
  for (const HeldBackLook& look : held_back)
    if (look.sensor == camera) groups.erase(look.capture);
  return groups;
}

// Needs what was held back.
void AddTrials(const SessionViews& views, const Explained& explained, SessionEstimate& estimate) {
  ParallelFor(estimate.misfits.size(), [&](std::size_t i) {
    LensMisfit& misfit = estimate.misfits[i];
    const auto seen = std::find_if(views.cameras.begin(), views.cameras.end(),
                                   [&](const CameraViews& one) { return one.camera.id == misfit.camera; });
    if (seen == views.cameras.end()) return;
    misfit.trial = TryLenses({seen->camera, seen->board, seen->views}, seen->estimate,
                             GroupsOfLooks(explained, misfit.camera, estimate.held_back));
  });
}

// Without the sensors of which the session says too little: their pairs stand as they are.
Result<SessionStart> StartOfWhatIsTold(const SessionViews& views) {
  std::set<SensorId> left_out;
  while (true) {
    RIGCAL_ASSIGN(SessionStart start, StartOf(views, left_out));
    const int open = OpenSensor(start.problem, start.state, start.noise, GroupsOf(start.problem, start.state));
    if (open == kNone) return start;
    left_out.insert(start.problem.sensors[static_cast<std::size_t>(open)]);
  }
}

SessionEstimate Estimate(const SessionViews& views) {
  auto start = StartOfWhatIsTold(views);
  if (!start) return Refused(views, NameOf(start.error().code), start.error());
  auto first = Explain(*start, GroupsOf(start->problem, start->state));
  if (!first) return Refused(views, kRefinementFailed, first.error());
  // A single view tells a place worse than a burst is wide; all views together do not.
  if (const CaptureGroups groups = GroupsOf(first->start.problem, first->refined.state);
      groups != first->refined.groups) {
    first = Explain(std::move(first->start), groups);
    if (!first) return Refused(views, kRefinementFailed, first.error());
  }
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.lost_sights = LostSightsTold(*start);
  const Explained last = ExplainAll(
      WithInstrumentEffects(WithoutContradictedPairs(WithClocksSettled(std::move(*first)), estimate)), estimate);
  if (auto no_lens = WhyNoLens(last.start.problem, last.refined.state)) return Refused(views, *no_lens);
  AddPoses(last, estimate);
  AddHeldBack(last, estimate);
  AddTrials(views, last, estimate);
  return estimate;
}

}  // namespace

SessionEstimate EstimateSession(const SessionViews& views) {
  try {
    return Estimate(views);
  } catch (const std::exception& exception) {
    return Refused(views, NameOf(ErrorCode::kInternal),
                   {ErrorCode::kInternal, std::string("the joint refinement broke off: ") + exception.what(),
                    "The calibration of the pairs stands; report this with the session's id."});
  }
}

}  // namespace rigcal::calib::joint
