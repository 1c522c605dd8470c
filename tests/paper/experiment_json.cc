#include "tests/paper/experiment_json.h"

#include <cmath>

namespace rigcal::paper {
namespace {

using nlohmann::json;

json Json(const Interval& interval) { return {interval.low, interval.high}; }

json Json(const GlobalRun& run) {
  const GlobalSample mean = run.Mean();
  json samples = json::array();
  for (const GlobalSample& sample : run.samples) samples.push_back({sample.before.total, sample.after.total});
  return {{"before", mean.before.total},
          {"before_predicted", run.predicted_before},
          {"before_over_predicted_interval", Json(run.IntervalBefore())},
          {"after", mean.after.total},
          {"after_predicted", run.predicted_after},
          {"after_over_predicted_interval", Json(run.IntervalAfter())},
          {"poses_rms_m", std::sqrt(mean.pose_m2)},
          {"poses_predicted_m", std::sqrt(run.predicted_pose_m2)},
          {"poses_rms_rad", std::sqrt(mean.pose_rad2)},
          {"poses_predicted_rad", std::sqrt(run.predicted_pose_rad2)},
          {"cost", mean.cost},
          {"whitened_ratio", mean.whitened_ratio},
          {"samples", std::move(samples)}};
}

json Json(const GlobalRuns& runs) { return {{"full", Json(runs.full)}, {"diagonal", Json(runs.diagonal)}}; }

json Json(const WayErrors& errors) {
  return {{"rms_m", Rms(errors.error_m)},
          {"rms_rad", Rms(errors.error_rad)},
          {"predicted_m", std::sqrt(errors.predicted_m2)},
          {"predicted_rad", std::sqrt(errors.predicted_rad2)},
          {"errors_m", errors.error_m},
          {"errors_rad", errors.error_rad}};
}

json Json(const WaySum& sum) {
  return {{"rms_m", sum.rms_m},
          {"predicted_m", sum.predicted_rms_m},
          {"square_over_predicted_interval_m", Json(IntervalOf(2 / sum.variance_m_ratio))},
          {"rms_rad", sum.rms_rad},
          {"predicted_rad", sum.predicted_rms_rad},
          {"square_over_predicted_interval_rad", Json(IntervalOf(2 / sum.variance_rad_ratio))}};
}

json Json(const Vector6d& v) { return std::vector<double>(v.data(), v.data() + 6); }

json Json(const MethodPair& pair) {
  json samples = json::array();
  for (const MethodSample& sample : pair.samples)
    samples.push_back({{"difference", Json(sample.difference)},
                       {"sigma_difference", Json(sample.sigma_difference)},
                       {"sigma_first", Json(sample.sigma_first)},
                       {"sigma_second", Json(sample.sigma_second)},
                       {"error_first", Json(sample.error_first)},
                       {"error_second", Json(sample.error_second)}});
  return {{"a", pair.a.str()}, {"b", pair.b.str()}, {"visits", std::move(samples)}};
}

}  // namespace

json FiguresOf(const NoiseExperiment& experiment) {
  const NoiseSums noise = MeanNoise(experiment), optimised = MeanOptimised(experiment);
  const NoiseSums &before = experiment.expected_noise, &after = experiment.expected_optimised;
  return {{"sets", experiment.sets.size()},
          {"whitened_ratio", optimised.whitened / noise.whitened},
          {"whitened_ratio_largest", LargestRatio(experiment)},
          {"translation_ratio", optimised.translation_m2 / noise.translation_m2},
          {"translation_ratio_predicted", after.translation_m2 / before.translation_m2},
          {"rotation_ratio", optimised.rotation_rad2 / noise.rotation_rad2},
          {"rotation_ratio_predicted", after.rotation_rad2 / before.rotation_rad2}};
}

json FiguresOf(const GlobalExperiment& experiment) {
  json noisy = json::array();
  for (const NoisyPair& pair : experiment.noisy_pairs)
    noisy.push_back({{"a", pair.a.str()},
                     {"b", pair.b.str()},
                     {"method", pair.method},
                     {"refusal", pair.refusal},
                     {"error_m", pair.error_m},
                     {"error_rad", pair.error_rad}});
  return {{"sensors", experiment.sensors},
          {"captures", experiment.captures},
          {"edges_min", experiment.edges_min},
          {"edge_rms_m", experiment.edge_rms_m},
          {"edge_rms_rad", experiment.edge_rms_rad},
          {"dof", experiment.dof},
          {"cost_over_dof_interval", Json(experiment.CostInterval())},
          {"whitened_ratio_expected", experiment.WhitenedExpected()},
          {"whitened_ratio_half_width", experiment.WhitenedHalfWidth()},
          {"noise_factor", experiment.noise_factor},
          {"noisy_pairs", std::move(noisy)},
          {"paper", {{"before", kPaperBefore}, {"after", kPaperAfter}}},
          {"visits", Json(experiment.visits)},
          {"realistic", Json(experiment.realistic)},
          {"paper_noise", Json(experiment.paper)}};
}

json FiguresOf(const ChainExperiment& experiment) {
  json routes = json::array(), sums;
  for (const Route& route : experiment.routes) {
    json one = {{"sensors", json::array()}, {"direct_method", route.direct_method}};
    for (const SensorId& sensor : route.sensors) one["sensors"].push_back(sensor.str());
    for (std::size_t way = 0; way < kWays; ++way) one[kWayNames[way]] = Json(route.ways[way]);
    routes.push_back(std::move(one));
  }
  for (std::size_t way = 0; way < kWays; ++way) sums[kWayNames[way]] = Json(experiment.sums[way]);
  return {{"visits", experiment.visits}, {"routes", std::move(routes)}, {"all", std::move(sums)}};
}

json FiguresOf(const MethodExperiment& experiment) {
  json families = json::array();
  for (const MethodFamily& family : experiment.families) {
    families.push_back({{"first", family.first},
                        {"second", family.second},
                        {"differences", family.coordinates},
                        {"within_3_sigma_ratio", family.within_3_sigma_ratio},
                        {"rms_sigmas", family.rms_sigmas},
                        {"pairs", json::array()}});
    for (const MethodPair& pair : family.pairs) families.back()["pairs"].push_back(Json(pair));
  }
  return {{"families", std::move(families)}};
}

}  // namespace rigcal::paper
