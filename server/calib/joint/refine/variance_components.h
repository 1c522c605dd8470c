// How large the random effects of several blocks are: restricted maximum likelihood (Patterson & Thompson 1971) from
// the information that is left of them when everything else is eliminated.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigcal::calib::joint {

// Effects c of blocks k, c_k ~ N(0, variance_k I), seen through a cost c^T S c / 2 + score^T c: the score at c = 0 is
// N(0, S + S D S).
struct RandomEffects {
  Eigen::MatrixXd S;
  Eigen::VectorXd score;
  std::vector<int> at;  // of each block, and the end
  // How many blocks there are, and how many effects one of them has.
  [[nodiscard]] std::size_t blocks() const { return at.empty() ? 0 : at.size() - 1; }
  [[nodiscard]] int size(std::size_t block) const { return at[block + 1] - at[block]; }
};

// Of each block the directions that are seen at all: S and score over them.
struct SeenEffects {
  std::vector<Eigen::MatrixXd> axes;  // per block: effects by directions, orthonormal columns
  RandomEffects along;
};

struct Components {
  std::vector<double> variance;  // per block; 0: nothing of it is seen
  // Per block: what twice the logarithm of the likelihood loses without it. Where a block has no effects half of all
  // are 0 and half are chi-square of one (Self & Liang 1987).
  std::vector<double> evidence;
  std::vector<double> dof;  // numbers that the effects of a block take up
  double complexity = 0.0;  // what effects of this size cost the likelihood: log det B + mean^T D^-1 mean
  Eigen::VectorXd mean;     // of the effects, given the score
  SeenEffects seen;
  Eigen::MatrixXd inverse_L;  // B = I + sqrt(D) S sqrt(D) = L L^T over the seen directions
};
// Fisher scoring from where the moments of the score point (MIVQUE). Deterministic for any number of threads.
[[nodiscard]] Components EstimateComponents(const RandomEffects& effects);

// by Cov(c | score) by^T, `by` over all effects; by_block of the effects of one block alone.
[[nodiscard]] Eigen::MatrixXd PosteriorThrough(const Components& components, const Eigen::MatrixXd& by);
[[nodiscard]] Eigen::MatrixXd PosteriorThrough(const Components& components, std::size_t block,
                                               const Eigen::MatrixXd& by_block);
// by D by^T: where the effects are left as they are.
[[nodiscard]] Eigen::MatrixXd PriorThrough(const Components& components, const Eigen::MatrixXd& by);

}  // namespace rigcal::calib::joint
