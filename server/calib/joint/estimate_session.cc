#include "server/calib/joint/estimate_session.h"

#include <algorithm>
#include <exception>
#include <tuple>

#include "server/calib/joint/explained.h"

namespace rigcal::calib::joint {
namespace {

constexpr double kHeldBackBelow = 0.5;  // of a look's weight

SessionEstimate Refused(const SessionViews& views, const Error& error) {
  SessionEstimate estimate;
  estimate.reference = views.reference;
  estimate.why_not.push_back({NameOf(error.code), error.what, error.cure});
  return estimate;
}

template <typename Looks>
void AddHeldBack(const SessionProblem& problem, const Looks& looks, const std::vector<double>& weights,
                 std::vector<HeldBackLook>& held_back) {
  for (std::size_t i = 0; i < looks.size(); ++i)
    if (weights[i] < kHeldBackBelow)
      held_back.push_back(
          {problem.sensors[static_cast<std::size_t>(looks[i].sensor)], CaptureAt(problem, looks[i].place)});
}

void AddPoses(const Explained& explained, SessionEstimate& estimate) {
  const SessionProblem& problem = explained.start.problem;
  const PoseCovariance covariance = CovarianceOfPoses(explained.refined, CovarianceByFields(explained.misfits));
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
    RefinedPose pose{problem.sensors[s], explained.refined.state.T_ref_sensor[s], Matrix6d::Zero(), covariance.dof[s]};
    if (const int row = covariance.row_of_sensor[s]; row != kNone)
      pose.covariance = covariance.joint.block<6, 6>(row, row);
    estimate.poses.push_back(std::move(pose));
  }
  std::sort(estimate.poses.begin(), estimate.poses.end(),
            [](const RefinedPose& x, const RefinedPose& y) { return x.sensor < y.sensor; });
  if (explained.misfits.any())
    estimate.misfits = MisfitsTold(problem, explained.refined, explained.misfits, covariance);
}

void AddHeldBack(const Explained& explained, SessionEstimate& estimate) {
  const SessionProblem& problem = explained.start.problem;
  const LookWeights& weights = explained.refined.weights;
  AddHeldBack(problem, problem.corners, weights.corners, estimate.held_back);
  AddHeldBack(problem, problem.plates, weights.plates, estimate.held_back);
  AddHeldBack(problem, problem.poses, weights.poses, estimate.held_back);
  std::sort(estimate.held_back.begin(), estimate.held_back.end(), [](const HeldBackLook& x, const HeldBackLook& y) {
    return std::tie(x.sensor, x.capture) < std::tie(y.sensor, y.capture);
  });
}

SessionEstimate Estimate(const SessionViews& views) {
  auto start = StartOf(views);
  if (!start) return Refused(views, start.error());
  auto first = Explain(*start, GroupsOf(start->problem, start->state));
  if (!first) return Refused(views, first.error());
  SessionEstimate estimate;
  estimate.reference = views.reference;
  const Explained last = WithoutMoves(*first, ExplainAll(*first, estimate.moved));
  AddPoses(last, estimate);
  AddHeldBack(last, estimate);
  return estimate;
}

}  // namespace

SessionEstimate EstimateSession(const SessionViews& views) {
  try {
    return Estimate(views);
  } catch (const std::exception& exception) {
    return Refused(views, {ErrorCode::kInternal, std::string("the joint refinement broke off: ") + exception.what(),
                           "The calibration of the pairs stands; report this with the session's id."});
  }
}

}  // namespace rigcal::calib::joint
