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
#include "server/calib/joint/misfit/given_lens.h"
#include "server/calib/joint/misfit/held_back.h"
#include "server/calib/joint/misfit/instrument_effects.h"
#include "server/calib/joint/misfit/lost_sight.h"
#include "server/calib/joint/misfit/pose_clock.h"
#include "server/calib/joint/misfit/print_strain.h"
#include "server/calib/joint/refine/lens_numbers.h"
#include "server/calib/joint/refine/session_groups.h"

namespace rigcal::calib::joint {
namespace {

SessionEstimate Refused(const SessionViews& views, Diagnosis why_not) {
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.why_not.push_back(std::move(why_not));
  return estimate;
}
SessionEstimate Refused(const SessionViews& views, const std::string& code, const Error& error) {
  return Refused(views, Diagnosis{code, error.what, error.cure});
}

// The poses that are told, by name: those of the end, against the reference as it was then.
class LastPoses {
 public:
  explicit LastPoses(const Explained& explained)
      : state_(explained.refined.state),
        problem_(explained.start.problem),
        last_(LastOfEach(problem_)),
        reference_(last_.at(problem_.sensors[static_cast<std::size_t>(problem_.reference)])) {}

  [[nodiscard]] const std::map<SensorId, int>& sensors() const { return last_; }  // indices of the problem

  [[nodiscard]] Se3 T_ref_sensor(int sensor) const {
    const Se3& T_first_sensor = state_.T_ref_sensor[static_cast<std::size_t>(sensor)];
    if (reference_ == problem_.reference) return T_first_sensor;
    return (state_.T_ref_sensor[static_cast<std::size_t>(reference_)].Inverse() * T_first_sensor).Normalized();
  }

  // Six rows for each, the reference left out, of the covariance of the problem's poses. A reference that was moved
  // moves each told pose T_last_s by -Ad(T_last_s^-1) of its own step.
  [[nodiscard]] Eigen::MatrixXd Covariance(const Eigen::MatrixXd& joint, const std::vector<int>& row_of_sensor) const {
    const auto row_of = [&](int sensor) { return row_of_sensor[static_cast<std::size_t>(sensor)]; };
    std::vector<Eigen::MatrixXd> rows;
    for (const auto& [id, sensor] : last_) {
      if (sensor == reference_) continue;
      Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6, joint.rows());
      if (row_of(sensor) != kNone) by.middleCols<6>(row_of(sensor)).setIdentity();
      if (row_of(reference_) != kNone) by.middleCols<6>(row_of(reference_)) = -Adjoint(T_ref_sensor(sensor).Inverse());
      rows.push_back(std::move(by));
    }
    const auto count = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd by(6 * count, joint.rows());
    for (Eigen::Index i = 0; i < count; ++i) by.middleRows<6>(6 * i) = rows[static_cast<std::size_t>(i)];
    return by * joint * by.transpose();
  }

 private:
  const SessionState& state_;
  const SessionProblem& problem_;
  std::map<SensorId, int> last_;
  int reference_;
};

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
  const Eigen::MatrixXd by_moves = CovarianceByMovesLeft(problem, explained.refined);
  if (by_clocks.size() + by_moves.size() > 0)
    covariance = CovarianceOfPoses(explained.refined, Together(beside, by_clocks), by_moves);
  const Eigen::MatrixXd scattered = std::max(1.0, covariance.spread_ratio) * explained.refined.covariance;
  estimate.lenses =
      LensesTold(problem, explained.refined, Together(Together(scattered, beside), Together(by_clocks, by_moves)));
  const LastPoses last(explained);
  std::vector<int> sensors;
  for (const auto& [id, s] : last.sensors()) sensors.push_back(s);
  const std::vector<SmallestMove> smallest = SmallestMovesTold(problem, explained.refined, sensors);
  for (const auto& [id, s] : last.sensors())
    estimate.poses.push_back(
        {id, last.T_ref_sensor(s), covariance.dof[static_cast<std::size_t>(s)], smallest[estimate.poses.size()]});
  estimate.covariance = last.Covariance(covariance.joint, covariance.row_of_sensor);
  estimate.groups = GroupsTold(problem, explained.refined, covariance, last.sensors());
  estimate.noise = NoiseTold(problem, explained.refined, last.sensors());
  if (!covariance.common.isZero(0)) estimate.common = last.Covariance(covariance.common, covariance.row_of_sensor);
  if (explained.misfits.any())
    estimate.misfits = MisfitsTold(problem, explained.refined, explained.misfits, covariance);
  estimate.slants = SlantsTold(problem, explained.refined, by_fields);
  estimate.pupil_shifts = PupilShiftsTold(problem, explained.refined, by_fields);
  estimate.bends = BendsTold(problem, explained.refined, by_fields);
  AttributeBends(explained, estimate.bends);
  estimate.stretches = StretchesTold(problem, explained.refined, Together(scattered, by_fields));
}

// Of a camera that moved: as it was last.
std::vector<LookScatter> LookScatterTold(const SessionProblem& problem, const Refined& refined) {
  std::map<SensorId, double> sigma_rad;
  for (const CornersSeen& seen : problem.corners) {
    const auto sensor = static_cast<std::size_t>(seen.sensor);
    const SensorNoise& noise = refined.noise[sensor];
    const double focal_px = refined.state.intrinsics[static_cast<std::size_t>(seen.camera)][0];
    if (noise.sigma_rad * focal_px > noise.sigma) sigma_rad[problem.sensors[sensor]] = noise.sigma_rad;
  }
  std::vector<LookScatter> told;
  for (const auto& [camera, sigma] : sigma_rad) told.push_back({camera, sigma});
  return told;
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

bool IsStretched(const TargetId& board, const SessionEstimate& estimate) {
  return std::any_of(estimate.stretches.begin(), estimate.stretches.end(),
                     [&](const PrintStretch& stretch) { return stretch.board == board; });
}

// Needs what was held back. Before a board that is not as it is described another lens may win for that alone.
void AddTrials(const SessionViews& views, const Explained& explained, SessionEstimate& estimate) {
  ParallelFor(estimate.misfits.size(), [&](std::size_t i) {
    LensMisfit& misfit = estimate.misfits[i];
    const auto seen = std::find_if(views.cameras.begin(), views.cameras.end(),
                                   [&](const CameraViews& one) { return one.camera.id == misfit.camera; });
    if (seen == views.cameras.end() || IsStretched(seen->board.id, estimate)) return;
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

// Prints first: what they do, lidar pairs and lenses would be blamed for.
Explained WithAllFound(const Explained& first, double strain_ratio, SessionEstimate& estimate) {
  return ExplainAll(WithInstrumentEffects(WithoutContradictedPairs(WithPrintStrain(first, strain_ratio), estimate)),
                    estimate);
}

// A move, or a lens that bends, hides a stretched print: where none was seen and something of these was taken out,
// prints are judged again, and if one is stretched all is done anew with it. What was seen at first stays: if it was of
// the move, it widens sigmas.
Explained WithStrainSettled(const Explained& first, SessionEstimate& estimate) {
  const SessionEstimate none = estimate;
  const double strain_ratio = PrintStrain_ratio(first);
  Explained last = WithAllFound(first, strain_ratio, estimate);
  const bool anything = !estimate.moved.empty() || !estimate.boards_moved.empty() ||
                        !estimate.contradicted_lenses.empty() || last.misfits.held;
  const double hidden_ratio = strain_ratio == 0.0 && anything ? PrintStrain_ratio(last) : 0.0;
  if (hidden_ratio == 0.0) return last;
  estimate = none;
  return WithAllFound(first, hidden_ratio, estimate);
}

std::vector<std::size_t> CamerasNamed(const SessionProblem& problem, const std::vector<ContradictedLens>& lenses) {
  std::set<std::size_t> cameras;
  for (const CornersSeen& seen : problem.corners)
    for (const ContradictedLens& lens : lenses)
      if (problem.sensors[static_cast<std::size_t>(seen.sensor)] == lens.camera)
        cameras.insert(static_cast<std::size_t>(seen.camera));
  return {cameras.begin(), cameras.end()};
}

// What was settled before wrong intrinsics were found (prints, lidar pairs, bends) may have been blamed for them: all
// is done anew without them. A stretched print makes the intrinsics of every camera that sees it look wrong: with that
// taken out, those are told that still are.
Explained WithLensesSettled(const Explained& first, SessionEstimate& estimate) {
  const SessionEstimate none = estimate;
  Explained last = WithStrainSettled(first, estimate);
  const std::vector<ContradictedLens> wrong = estimate.contradicted_lenses;
  if (wrong.empty()) return last;
  auto freed = Explain(WithLensesFree(first.start, first.refined, CamerasNamed(first.start.problem, wrong)),
                       first.refined.groups);
  if (!freed) return last;
  estimate = none;
  last = WithStrainSettled(*freed, estimate);
  std::vector<ContradictedLens>& told = estimate.contradicted_lenses;
  const std::vector<ContradictedLens> still = StillContradicted(wrong, first.start.problem, last);
  told.insert(told.end(), still.begin(), still.end());
  std::sort(told.begin(), told.end(),
            [](const ContradictedLens& x, const ContradictedLens& y) { return x.camera < y.camera; });
  return last;
}

// Where noises find no rest, looks may err as a whole.
Result<Explained> ExplainFirst(SessionStart start, const CaptureGroups& groups) {
  auto plain = Explain(start, groups);
  if (plain) return plain;
  start.noise = WithLooksThatErr(start.problem, start.noise);
  auto erring = Explain(std::move(start), groups);
  return erring ? std::move(erring) : std::move(plain);
}

// Where cameras still do not fit each other from capture to capture when all else is explained, their looks may err as
// a whole: all is done anew with it, and kept where it explains more beyond doubt. Not where it
// accuses whom nothing else does.
Explained WithLookErrorsSettled(Explained first, SessionEstimate& estimate) {
  constexpr double kLookScatterMax = 2.0;
  SessionEstimate with_errors = estimate;
  Explained last = WithLensesSettled(first, estimate);
  if (LooksErr(first.start.problem, first.refined.noise)) return last;
  if (LooksBesideEachOther(last.start.problem, last.refined) <= kLookScatterMax) return last;
  first.start.noise = WithLooksThatErr(first.start.problem, first.start.noise);
  auto erring = Explain(std::move(first.start), first.refined.groups);
  if (!erring) return last;
  Explained other = WithLensesSettled(*erring, with_errors);
  const bool accuses_more = with_errors.moved.size() > estimate.moved.size();
  if (accuses_more || LookScatterTold(other.start.problem, other.refined).empty() || !ExplainsMore(other, last))
    return last;
  estimate = std::move(with_errors);
  return other;
}

// Of several trackers the first alone: another that the rest does not fit takes no part, and its pairs stand.
SessionViews WithFirstTrackerOnly(SessionViews views) {
  views.trackers.resize(1);
  return views;
}

SessionEstimate Estimate(const SessionViews& views) {
  auto start = StartOfWhatIsTold(views);
  if (!start) return Refused(views, NameOf(start.error().code), start.error());
  auto first = ExplainFirst(*start, GroupsOf(start->problem, start->state));
  if (!first && views.trackers.size() > 1) return Estimate(WithFirstTrackerOnly(views));
  if (!first) return Refused(views, kRefinementFailed, first.error());
  // A single view tells a place worse than a burst is wide; all views together do not.
  if (const CaptureGroups groups = GroupsOf(first->start.problem, first->refined.state);
      groups != first->refined.groups) {
    first = ExplainFirst(std::move(first->start), groups);
    if (!first) return Refused(views, kRefinementFailed, first.error());
  }
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.lost_sights = LostSightsTold(*start);
  const Explained last = WithLookErrorsSettled(WithClocksSettled(std::move(*first)), estimate);
  if (auto no_lens = WhyNoLens(last.start.problem, last.refined.state)) return Refused(views, *no_lens);
  AddPoses(last, estimate);
  estimate.held_back = LooksHeldBack(last.start.problem, last.refined);
  estimate.look_scatter = LookScatterTold(last.start.problem, last.refined);
  estimate.late = LateContradictions(last.start.problem, last.refined);
  AddTrials(views, last, estimate);
  const std::vector<HeldBackLook> left_out = LooksLeftOut(*start);
  estimate.held_back.insert(estimate.held_back.end(), left_out.begin(), left_out.end());
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
