#include "server/model/edges/weak_edge.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/model/edges/merged_edge.h"

namespace rigcal {
namespace {

double SigmasRatioOf(const Matrix6d& Omega) {
  const Vector6d of_axes = Eigen::SelfAdjointEigenSolver<Matrix6d>(Omega, Eigen::EigenvaluesOnly).eigenvalues();
  return std::sqrt(of_axes[5] / of_axes[0]);
}

}  // namespace

std::string WhyWeak(const Edge& edge) {
  if (edge.state != EdgeState::kGood || (edge.session.empty() && !IsMergedOfSessions(edge))) return {};
  if (edge.figures.contains(kMergedWeak)) return "its sessions are weak";
  if (edge.uncertainty.rank < 6) return "it sees " + std::to_string(edge.uncertainty.rank) + " of 6 directions";
  const auto overlap = edge.figures.find("overlap_ratio");
  if (overlap != edge.figures.end() && overlap->second < kWeakOverlap_ratio)
    return std::to_string(std::lround(100.0 * overlap->second)) + " % of one cloud lie where the other has points";
  if (SigmasRatioOf(edge.uncertainty.Omega) > kWeakSigmasRatio) return "it hardly sees one of the six directions";
  return {};
}

}  // namespace rigcal
