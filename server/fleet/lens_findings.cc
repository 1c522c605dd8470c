#include <algorithm>
#include <set>

#include "server/fleet/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// A sigma that is larger by half, and by more than any mount holds still, is worth a better lens model; what adds less
// is in the sigmas, and nobody need act on it.
constexpr double kMatters = 1.5, kMattersMin_m = 5e-5, kMattersMin_rad = 5e-5;

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
         " cannot: " + (one ? "" : "worst is " + worst.camera.str() + ", ") + "by " + Number(worst.rms_px, "px") +
         " rms, which makes poses uncertain by " + Number(1e3 * worst.pose_sigma_m, "mm") + " and " +
         Number(kDegreesPerRadian * worst.pose_sigma_rad, "deg");
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
         ", and have their intrinsics estimated (give `intrinsics_sigma`, or leave the intrinsics out)";
}

std::set<SessionId> SessionsIn(const std::vector<Edge>& edges, const GraphSolution& solution) {
  std::set<EdgeId> counted;
  for (const EdgeResidual& residual : solution.residuals)
    if (residual.in_solution) counted.insert(residual.edge);
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (counted.contains(edge.id)) sessions.insert(edge.session);
  return sessions;
}

// Off by more than a lens makes of it, and beyond chance where that can be tested.
bool IsGross(const Edge& edge, const EdgeResidual& residual, std::size_t edge_count, const Policy& policy) {
  const EdgeTest test = TestResidual(edge, residual, edge_count, policy);
  const bool is_far =
      residual.e.head<3>().norm() > policy.residual_max_m || residual.e.tail<3>().norm() > policy.residual_max_rad;
  return residual.in_solution && is_far && (test.limit <= 0.0 || test.statistic > test.limit);
}

bool IsAnyGross(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  return std::any_of(solution.residuals.begin(), solution.residuals.end(), [&](const EdgeResidual& residual) {
    const auto edge =
        std::find_if(edges.begin(), edges.end(), [&](const Edge& one) { return one.id == residual.edge; });
    return edge != edges.end() && IsGross(*edge, residual, solution.residuals.size(), policy);
  });
}

}  // namespace

bool LensesExplain(const std::vector<Edge>& edges, const GraphSolution& solution,
                   const std::vector<SessionEstimate>& estimates, const Policy& policy) {
  const std::set<SessionId> sessions = SessionsIn(edges, solution);
  if (sessions.size() != 1 || sessions.begin()->empty()) return false;
  const auto bent = std::find_if(estimates.begin(), estimates.end(), [&](const SessionEstimate& estimate) {
    return estimate.session == *sessions.begin() && estimate.why_not.empty() && !estimate.misfits.empty() &&
           estimate.moved.empty();
  });
  return bent != estimates.end() && !IsAnyGross(edges, solution, policy);
}

std::optional<Finding> FindLensMisfits(const std::vector<SessionEstimate>& estimates, bool edges_disagree) {
  std::vector<LensMisfit> misfits = NewestOf(estimates);
  if (!edges_disagree) std::erase_if(misfits, [](const LensMisfit& one) { return !Matters(one); });
  if (misfits.empty()) return std::nullopt;
  std::stable_sort(misfits.begin(), misfits.end(),
                   [](const LensMisfit& x, const LensMisfit& y) { return x.sigma_ratio > y.sigma_ratio; });
  Finding finding{WhyOf(misfits, misfits.front()), CureOf(misfits)};
  if (edges_disagree) finding.why = "edges disagree beyond chance because " + finding.why;
  return finding;
}

}  // namespace rigcal::fleet
