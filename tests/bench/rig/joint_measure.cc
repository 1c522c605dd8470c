// The joint refinement of the virtual MARS Mapper at feature level: how near it comes to the Cramer-Rao bound, whether
// its regions hold, how long it takes, and what the scan for moved sensors says. joint_measure SEEDS [--first N]
// [--bump SENSOR MM DEG] [--misfit PX] [--captures N] [--bursts N] [--intrinsics exact|calibrated|absent]
// prints one JSON object.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "client/sim/bound.h"
#include "server/calib/joint/estimate_session.h"
#include "server/calib/joint/misfit/lens_misfit.h"
#include "server/calib/joint/misfit/moved_pose.h"
#include "server/calib/joint/refine/cluster_covariance.h"
#include "server/math/statistics.h"
#include "tests/bench/rig/joint_session.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

struct Sums {
  double error_m2 = 0, error_rad2 = 0, bound_m2 = 0, bound_rad2 = 0, t2 = 0, dof = 0, sigma_ratio = 0;
  double t2_model = 0, t2_scatter = 0;  // by H^-1 alone; with what groups scatter by, and nothing beside it
  int count = 0, covered = 0;
};

struct Settings {
  sim::Options options;
  int first = 1, seeds = 1;
};

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

Settings Parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--first") {
      settings.first = std::atoi(argv[++i]);
    } else if (word == "--captures") {
      settings.options.captures = std::atoi(argv[++i]);
    } else if (word == "--bursts") {
      settings.options.disturb.burst = std::atoi(argv[++i]);
    } else if (word == "--misfit") {
      settings.options.disturb.lens_misfit_px = std::atof(argv[++i]);
    } else if (word == "--bump") {
      settings.options.bump = SensorId(argv[++i]);
      settings.options.bump_m = std::atof(argv[++i]) / 1e3;
      settings.options.bump_rad = std::atof(argv[++i]) * M_PI / 180;
    } else if (word == "--intrinsics") {
      const std::string kind = argv[++i];
      settings.options.intrinsics = kind == "exact"    ? sim::IntrinsicsKind::kExact
                                    : kind == "absent" ? sim::IntrinsicsKind::kAbsent
                                                       : sim::IntrinsicsKind::kCalibrated;
    } else {
      settings.seeds = std::atoi(argv[i]);
    }
  }
  return settings;
}

void AddPoses(const FeatureSession& session, const calib::joint::SessionProblem& problem,
              const SessionEstimate& estimate, const calib::joint::PoseCovariance& plain,
              std::map<std::string, Sums>& sums) {
  const auto bound = sim::CramerRaoBound(session.experiment);
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    const RefinedPose& pose = estimate.poses[i];
    if (RowOf(estimate, i) < 0) continue;
    const Matrix6d C = estimate.covariance.block<6, 6>(RowOf(estimate, i), RowOf(estimate, i));
    const auto s = static_cast<std::size_t>(std::find(problem.sensors.begin(), problem.sensors.end(), pose.sensor) -
                                            problem.sensors.begin());
    const int row = plain.row_of_sensor[s];
    if (row == calib::joint::kNone) continue;
    const Vector6d error = (pose.T_ref_sensor.Inverse() * session.experiment.T_ref_sensor(pose.sensor)).Log();
    Sums& sum = sums[pose.sensor.str()];
    sum.error_m2 += error.head<3>().squaredNorm(), sum.error_rad2 += error.tail<3>().squaredNorm();
    for (std::size_t axis = 0; axis < 6; ++axis)
      (axis < 3 ? sum.bound_m2 : sum.bound_rad2) += std::pow(bound.at(pose.sensor)[axis].value_or(0.0), 2);
    const double t2 = error.dot(C.ldlt().solve(error));
    sum.t2 += t2, sum.dof += pose.dof, ++sum.count;
    sum.t2_model += error.dot(Matrix6d(plain.model.block<6, 6>(row, row)).ldlt().solve(error));
    sum.t2_scatter += error.dot(Matrix6d(plain.joint.block<6, 6>(row, row)).ldlt().solve(error));
    sum.sigma_ratio += std::sqrt(C.trace() / plain.model.block<6, 6>(row, row).trace());
    sum.covered +=
        t2 <= (pose.dof > 0 ? HotellingLimit(static_cast<int>(pose.dof + 1e-6) + 1) : ChiSquareQuantile(0.95, 6));
  }
}

void PrintFound(const SessionEstimate& estimate) {
  for (const SensorMovedWithin& moved : estimate.moved)
    std::printf(", {\"moved\": \"%s\", \"odds\": %.3g, \"mm\": %.3f}", moved.sensor.str().c_str(), moved.odds,
                1e3 * moved.step.head<3>().norm());
  for (const LensMisfit& misfit : estimate.misfits)
    std::printf(", {\"misfit\": \"%s\", \"px\": %.4f, \"evidence\": %.0f, \"mm\": %.3f, \"ratio\": %.2f}",
                misfit.camera.str().c_str(), misfit.rms_px, misfit.evidence, 1e3 * misfit.pose_sigma_m,
                misfit.sigma_ratio);
}

/// What the parts of the refinement took, in seconds, and how much the groups of captures widen the model's sigma.
struct Costs {
  double start_s = 0, refine_s = 0, covariance_s = 0, scan_s = 0, fields_s = 0, whole_s = 0;
  double model_ratio = 0, spread_ratio = 0;
};

template <typename Part>
auto Timed(double& total_s, const Part& part) {
  const auto since = std::chrono::steady_clock::now();
  auto result = part();
  total_s += Seconds(since);
  return result;
}

std::string NameOf(const calib::joint::StillFrame& frame) {
  return frame.tracker.empty() ? frame.board.str() : "world of " + frame.tracker.str();
}

void PrintMoves(const calib::joint::SessionProblem& problem, const std::vector<calib::joint::Move>& moves) {
  for (std::size_t m = 0; m < std::min<std::size_t>(3, moves.size()); ++m)
    std::printf(", {\"moved\": \"%s\", \"group\": %d, \"f\": %.3g, \"odds\": %.3g, \"mm\": %.3f, \"deg\": %.4f}",
                moves[m].board == calib::joint::kNone
                    ? problem.sensors[static_cast<std::size_t>(moves[m].sensor)].str().c_str()
                    : NameOf(problem.boards[static_cast<std::size_t>(moves[m].board)]).c_str(),
                moves[m].group, moves[m].statistic, moves[m].odds, 1e3 * moves[m].step.head<3>().norm(),
                180 / M_PI * moves[m].step.tail<3>().norm());
}

void TellFirst(const calib::joint::SessionProblem& problem, const calib::joint::Refined& refined,
               const calib::joint::Components& components) {
  for (std::size_t s = 0; s < problem.sensors.size(); ++s)
    std::fprintf(stderr, "%s noise %.4g %.4g\n", problem.sensors[s].str().c_str(), refined.noise[s].sigma,
                 refined.noise[s].sigma_rad);
  for (std::size_t k = 0; k < components.variance.size(); ++k)
    std::fprintf(stderr, "field %zu sigma_px %.4f evidence %.1f dof %.1f seen %td\n", k,
                 std::sqrt(components.variance[k]), components.evidence[k], components.dof[k],
                 components.seen.axes[k].cols());
}

/// Refines one session of the drawn noise, part by part and whole. False, with the reason on stderr: it could not
/// start.
bool MeasureSession(const sim::Options& options, bool first, Costs& costs, std::map<std::string, Sums>& sums) {
  const FeatureSession session = RecordFeatures(MarsMapper(options), 0);
  const auto views = ViewsOf(session, NominalPoses(session));
  const auto start = Timed(costs.start_s, [&] { return calib::joint::StartOf(views); });
  if (!start) return std::fprintf(stderr, "%s\n", Sentence(start.error()).c_str()), false;
  const auto groups = calib::joint::GroupsOf(start->problem, start->state);
  const auto refined =
      Timed(costs.refine_s, [&] { return calib::joint::Refine(start->problem, start->state, start->noise, groups); });
  if (!refined) return std::fprintf(stderr, "%s\n", Sentence(refined.error()).c_str()), false;
  const auto covariance = Timed(costs.covariance_s, [&] { return calib::joint::CovarianceOfPoses(*refined); });
  const auto moves = Timed(costs.scan_s, [&] { return calib::joint::ScanForMoves(start->problem, *refined); });
  const auto misfits = Timed(costs.fields_s, [&] { return calib::joint::FindMisfits(start->problem, *refined); });
  const auto estimate = Timed(costs.whole_s, [&] { return calib::joint::EstimateSession(views); });
  costs.model_ratio += covariance.model_ratio, costs.spread_ratio += covariance.spread_ratio;
  AddPoses(session, start->problem, estimate, covariance, sums);
  std::printf("%s\n[%llu", first ? "" : ",", static_cast<unsigned long long>(options.seed));
  PrintMoves(start->problem, moves);
  PrintFound(estimate);
  std::printf("]");
  if (first) TellFirst(start->problem, *refined, misfits.components);
  return true;
}

void PrintSums(const Costs& c, double n, const std::map<std::string, Sums>& sums) {
  std::printf(
      "],\n\"start_s\": %.3f, \"refine_s\": %.3f, \"covariance_s\": %.3f, \"scan_s\": %.3f, "
      "\"fields_s\": %.3f, \"whole_s\": %.3f, \"model_ratio\": %.3f, \"spread_ratio\": %.3f,\n\"sensors\": {",
      c.start_s / n, c.refine_s / n, c.covariance_s / n, c.scan_s / n, c.fields_s / n, c.whole_s / n, c.model_ratio / n,
      c.spread_ratio / n);
  const char* comma = "";
  for (const auto& [name, s] : sums) {
    std::printf(
        "%s\n\"%s\": {\"ratio_translation\": %.3f, \"ratio_rotation\": %.3f, \"mean_t2\": %.2f, "
        "\"mean_t2_model\": %.2f, \"mean_t2_scatter\": %.2f, \"covered\": %.3f, \"dof\": %.1f, \"sigma_over_model\": "
        "%.3f, \"rms_mm\": %.4f}",
        comma, name.c_str(), std::sqrt(s.error_m2 / s.bound_m2), std::sqrt(s.error_rad2 / s.bound_rad2), s.t2 / s.count,
        s.t2_model / s.count, s.t2_scatter / s.count, static_cast<double>(s.covered) / s.count, s.dof / s.count,
        s.sigma_ratio / s.count, 1e3 * std::sqrt(s.error_m2 / s.count));
    comma = ",";
  }
  std::printf("}}\n");
}

int Measure(const Settings& settings) {
  std::map<std::string, Sums> sums;
  Costs costs;
  std::printf("{\"moves\": [");
  for (int i = 0; i < settings.seeds; ++i) {
    sim::Options options = settings.options;
    options.seed = static_cast<std::uint64_t>(settings.first + i);
    if (!MeasureSession(options, i == 0, costs, sums)) return 1;
  }
  PrintSums(costs, settings.seeds, sums);
  return 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) { return rigcal::Measure(rigcal::Parse(argc, argv)); }
