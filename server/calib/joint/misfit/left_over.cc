#include "server/calib/joint/misfit/left_over.h"

#include <cmath>

#include "server/calib/joint/misfit/given_lens.h"

namespace rigcal::calib::joint {

double Unexplained(const Explained& explained, const std::vector<double>& in_burst) {
  const SessionProblem& problem = explained.start.problem;
  const SessionFit& fit = explained.refined.at_optimum.fit;
  double left = 0.0;
  const auto add = [&](const LookFit& look, double weight, double share, const SensorNoise& noise) {
    left += share * (weight * look.squares.sum() + 2 * look.numbers[0] * std::log(noise.sigma));
    left += share * look.log_det;
  };
  const auto add_all = [&](const auto& looks, const std::vector<LookFit>& fits, const std::vector<double>& weights,
                           const auto& share) {
    for (std::size_t i = 0; i < looks.size(); ++i)
      add(fits[i], weights[i], share(i), explained.refined.noise[static_cast<std::size_t>(looks[i].sensor)]);
  };
  const LookWeights& weights = explained.refined.weights;
  const auto alone = [](std::size_t) { return 1.0; };
  add_all(problem.corners, fit.corners, weights.corners, [&](std::size_t i) { return in_burst[i]; });
  add_all(problem.plates, fit.plates, weights.plates, alone);
  add_all(problem.poses, fit.poses, weights.poses, alone);
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    left += 2 * fit.poses[i].numbers[1] *
            std::log(explained.refined.noise[static_cast<std::size_t>(problem.poses[i].sensor)].sigma_rad);
  return left;
}

double UnexplainedInTwo(const Explained& explained, const std::vector<double>& in_burst, const SensorId& name,
                        int group) {
  const SessionProblem& problem = explained.start.problem;
  std::vector<double> share = in_burst;
  double squares[2] = {0, 0}, numbers[2] = {0, 0}, of_errors = 0.0;
  for (std::size_t i = 0; i < problem.corners.size(); ++i) {
    const auto sensor = static_cast<std::size_t>(problem.corners[i].sensor);
    if (problem.sensors[sensor] != name) continue;
    const LookFit& look = explained.refined.at_optimum.fit.corners[i];
    const double sigma = explained.refined.noise[sensor].sigma;
    const int side =
        explained.refined.groups.group_of_place[static_cast<std::size_t>(problem.corners[i].place)] >= group ? 1 : 0;
    squares[side] += share[i] * explained.refined.weights.corners[i] * look.squares[0] * sigma * sigma;
    numbers[side] += share[i] * look.numbers[0];
    of_errors += share[i] * (explained.refined.weights.corners[i] * look.squares[1] + look.log_det);
    share[i] = 0.0;
  }
  double left = Unexplained(explained, share) + of_errors;
  for (const int side : {0, 1})
    if (numbers[side] > 0) left += numbers[side] * std::log(squares[side] / numbers[side]);
  return left;
}

double LeftOver(const Explained& explained, const std::vector<double>& in_burst) {
  const SessionProblem& problem = explained.start.problem;
  const auto poses = static_cast<double>(problem.sensors.size() + problem.boards.size());
  double numbers = 6 * poses + 4 * static_cast<double>(problem.cameras.size());
  for (const Lens& lens : problem.cameras) numbers += lens.is_freed ? static_cast<double>(lens.refined.size()) : 0.0;
  const double fields = explained.misfits.held ? explained.misfits.components.complexity : 0.0;
  return Unexplained(explained, in_burst) + LensPull(problem, explained.refined.state) + fields +
         std::log(static_cast<double>(problem.corners.size())) * numbers;
}

}  // namespace rigcal::calib::joint
