// How honest the uncertainty of the graph is, against known truth; prints one JSON object.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/jackknife.h"
#include "server/math/statistics.h"
#include "tests/unit/graph/random.h"

namespace rigcal::graph {
namespace {

constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 / 57.29577951308232;

enum class Kind { kIsotropic, kAnisotropic, kDeficient };

Se3 TruthOf(const RandomRig& rig, const GraphEdge& edge) {
  return rig.truth[std::stoul(edge.frame_a.str())].Inverse() * rig.truth[std::stoul(edge.frame_b.str())];
}

// Every fifth edge sees no translation along, and no rotation about, its own z axis.
void MakeDeficient(Graph& graph) {
  for (std::size_t k = 4; k < graph.edges.size(); k += 5) {
    Matrix6d& Omega = graph.edges[k].Omega;
    for (const int axis : {2, 5}) Omega.row(axis).setZero(), Omega.col(axis).setZero();
    graph.edges[k].rank = 4;
  }
}

// A draw from N(0, Omega^+), with a large error where the edge sees nothing.
Vector6d DrawFor(std::mt19937& random, const Matrix6d& Omega, int rank) {
  if (rank == 6) return DrawError(random, Omega);
  const ObservableSubspace seen = Observable(Omega);
  const Matrix6d L = Matrix6d(seen.covariance + 1e-30 * Matrix6d::Identity()).llt().matrixL();
  return L * RandomVector(random, 1.0, 1.0) +
         seen.unobservable_basis * (seen.unobservable_basis.transpose() * RandomVector(random, 0.02, 0.02));
}

struct Coverage {
  int outside = 0, statistics = 0;
  double worst = 1.0;  // mean NEES / 6 furthest from 1
};

double Nees(const Vector6d& error, const Matrix6d& C) { return error.dot(C.ldlt().solve(error)); }

// Mean NEES of every sensor and of ten pairs over `draws`, and how many lie outside the 99 % interval.
Coverage MeasureNees(Kind kind, int draws) {
  RandomRig rig = MakeRig(12, 59, 77, kSigma_m, kSigma_rad, kind != Kind::kIsotropic);
  if (kind == Kind::kDeficient) MakeDeficient(rig.graph);
  std::mt19937 random(78);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 1; k <= 10; ++k) pairs.emplace_back(k, k % 11 + 1);
  std::vector<double> sums(11 + pairs.size(), 0.0);
  for (int draw = 0; draw < draws; ++draw) {
    for (GraphEdge& edge : rig.graph.edges)
      edge.T_a_b = TruthOf(rig, edge) * Se3::Exp(-DrawFor(random, edge.Omega, edge.rank));
    const GraphSolution solution = Solve(rig.graph);
    for (std::size_t v = 1; v < 12; ++v)
      sums[v - 1] +=
          Nees((rig.truth[v].Inverse() * solution.poses[v].T_ref_sensor).Log(), solution.poses[v].covariance);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto relative = Relative(rig.graph, solution, Name(pairs[p].first), Name(pairs[p].second));
      const Se3 truth = rig.truth[pairs[p].first].Inverse() * rig.truth[pairs[p].second];
      sums[11 + p] += relative ? Nees((truth.Inverse() * relative->T_A_B).Log(), relative->covariance) : 1e9;
    }
  }
  Coverage coverage;
  const double tail = 0.01 / 2.0 / static_cast<double>(sums.size());
  for (const double sum : sums) {
    ++coverage.statistics;
    if (sum < ChiSquareQuantile(tail, 6.0 * draws) || sum > ChiSquareQuantile(1.0 - tail, 6.0 * draws))
      ++coverage.outside;
    const double mean = sum / draws / 6.0;
    if (std::abs(mean - 1.0) > std::abs(coverage.worst - 1.0)) coverage.worst = mean;
  }
  return coverage;
}

struct Sums {
  double mean = 0.0, largest = 0.0;
};

// Weighted errors against the truth after the solve over those before; expected (N_V - 1)/N_E.
Sums MeasureSums(std::size_t vertices, std::size_t edges, bool complete, int sets) {
  Sums sums;
  for (int set = 0; set < sets; ++set) {
    RandomRig rig = MakeRig(vertices, edges, 1000 + static_cast<unsigned>(set), kSigma_m, kSigma_rad, false);
    std::mt19937 random(5000 + static_cast<unsigned>(set));
    std::size_t k = 0;
    for (std::size_t a = 0; complete && a < vertices; ++a)
      for (std::size_t b = a + 1; b < vertices; ++b, ++k)
        rig.graph.edges[k].frame_a = Name(a), rig.graph.edges[k].frame_b = Name(b);
    double before = 0.0, after = 0.0;
    for (GraphEdge& edge : rig.graph.edges) {
      const Vector6d e = DrawError(random, edge.Omega);
      edge.T_a_b = TruthOf(rig, edge) * Se3::Exp(e);
      before += e.dot(edge.Omega * e);
    }
    const GraphSolution solution = Solve(rig.graph);
    for (const GraphEdge& edge : rig.graph.edges) {
      const Se3 T = solution.poses[std::stoul(edge.frame_a.str())].T_ref_sensor.Inverse() *
                    solution.poses[std::stoul(edge.frame_b.str())].T_ref_sensor;
      const Vector6d e = (TruthOf(rig, edge).Inverse() * T).Log();
      after += e.dot(edge.Omega * e);
    }
    sums.mean += after / before / sets;
    sums.largest = std::max(sums.largest, after / before);
  }
  return sums;
}

constexpr std::size_t kCameras = 5;

// One session of a camera rig: every capture errs once per camera, alike in all its pairs, and a little per pair.
struct Session {
  RandomRig rig;
  BlocksByEdge blocks;
};

Session SimulateSession(int m, unsigned seed) {
  Session session;
  session.rig = MakeRig(kCameras, kCameras * (kCameras - 1) / 2, 31, kSigma_m, kSigma_rad, false);
  std::mt19937 random(seed);
  std::vector<std::vector<Vector6d>> of_camera(kCameras);
  for (auto& errors : of_camera)
    for (int i = 0; i < m; ++i) errors.push_back(RandomVector(random, kSigma_m, kSigma_rad));
  std::size_t k = 0;
  for (std::size_t a = 0; a < kCameras; ++a)
    for (std::size_t b = a + 1; b < kCameras; ++b, ++k) {
      GraphEdge& edge = session.rig.graph.edges[k];
      edge.frame_a = Name(a), edge.frame_b = Name(b);
      edge.session = SessionId(std::string(64, 'a'));
      const Se3 truth = TruthOf(session.rig, edge);
      const Matrix6d A = Adjoint(truth.Inverse());
      std::vector<Vector6d> errors;
      Vector6d mean = Vector6d::Zero();
      for (int i = 0; i < m; ++i) {
        const auto capture = static_cast<std::size_t>(i);
        errors.push_back(of_camera[b][capture] - A * of_camera[a][capture] +
                         RandomVector(random, 0.3 * kSigma_m, 0.3 * kSigma_rad));
        mean += errors.back() / m;
      }
      EdgeBlocks& own = session.blocks[edge.id];
      std::vector<Vector6d> d;
      for (int i = 0; i < m; ++i) {
        d.push_back(-(errors[static_cast<std::size_t>(i)] - mean) / (m - 1));
        own.blocks.push_back({std::to_string(100 + i), d.back()});
      }
      own.dof = edge.dof = m - 1;
      Vector6d variance;
      variance << Eigen::Vector3d::Constant(kSigma_m * kSigma_m), Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
      const Matrix6d C_camera = variance.asDiagonal();
      const Matrix6d C_model = (1.09 * C_camera + A * C_camera * A.transpose()) / m;
      edge.T_a_b = truth * Se3::Exp(mean);
      edge.Omega = Symmetrized(JackknifeOrModel(d, C_model).inverse());
    }
  return session;
}

struct Regions {
  double honest = 0.0, independent = 0.0, independent_same_limit = 0.0, residuals = 0.0, sigma_ratio = 0.0;
};

// Who takes the edges as independent adds up their degrees of freedom too (Welch and Satterthwaite): of a sensor's
// variance in a complete graph of 5 the direct edge brings 0.4, and each of the 6 of the detours 0.1.
int BlocksIfIndependent(int m) { return 1 + static_cast<int>((m - 1) / (0.4 * 0.4 + 6 * 0.1 * 0.1)); }

// How often the 95 % T^2 regions hold the true pose of a sensor, and the residual of an edge.
Regions MeasureRegions(int m, int seeds) {
  Regions regions;
  int poses = 0, residuals = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const Session session = SimulateSession(m, 9000 + static_cast<unsigned>(seed));
    GraphSolution solution = Solve(session.rig.graph);
    ApplyJackknifeCovariance(session.rig.graph, JackknifeGraph(session.rig.graph, solution, session.blocks), solution);
    for (std::size_t v = 1; v < kCameras; ++v, ++poses) {
      const SensorPose& pose = solution.poses[v];
      const Vector6d error = (session.rig.truth[v].Inverse() * pose.T_ref_sensor).Log();
      regions.honest += Nees(error, pose.covariance) <= HotellingLimit(m) ? 1.0 : 0.0;
      const double independent = Nees(error, pose.covariance_analytic);
      regions.independent += independent <= HotellingLimit(BlocksIfIndependent(m)) ? 1.0 : 0.0;
      regions.independent_same_limit += independent <= HotellingLimit(m) ? 1.0 : 0.0;
      regions.sigma_ratio += SigmaRatio(pose.covariance, pose.covariance_analytic).mean();
    }
    for (const EdgeResidual& residual : solution.residuals) {
      if (residual.rank < 1) continue;
      ++residuals;
      regions.residuals +=
          residual.t_squared <= HotellingLimit(static_cast<int>(residual.dof + 1e-6) + 1, residual.rank) ? 1.0 : 0.0;
    }
  }
  regions.honest /= poses, regions.independent /= poses, regions.independent_same_limit /= poses,
      regions.sigma_ratio /= poses;
  regions.residuals /= std::max(residuals, 1);
  return regions;
}

void PrintNees(const char* name, Kind kind) {
  const Coverage coverage = MeasureNees(kind, 1000);
  std::printf("\"nees_%s_outside\": %d, \"nees_%s_statistics\": %d, \"nees_%s_worst\": %.6f, ", name, coverage.outside,
              name, coverage.statistics, name, coverage.worst);
}

void PrintRegions(int m) {
  const Regions regions = MeasureRegions(m, 500);
  std::printf(
      ", \"t2_%d_coverage\": %.6f, \"t2_%d_independent\": %.6f, \"t2_%d_independent_same_limit\": %.6f, "
      "\"t2_%d_residuals\": %.6f, "
      "\"t2_%d_sigma_ratio\": %.6f",
      m, regions.honest, m, regions.independent, m, regions.independent_same_limit, m, regions.residuals, m,
      regions.sigma_ratio);
}

void Run() {
  std::printf("{");
  PrintNees("isotropic", Kind::kIsotropic);
  PrintNees("anisotropic", Kind::kAnisotropic);
  PrintNees("deficient", Kind::kDeficient);
  const Sums k4 = MeasureSums(4, 6, true, 300), rig = MeasureSums(12, 59, false, 300);
  std::printf("\"sums_k4\": %.6f, \"sums_k4_largest\": %.6f, \"sums_12_59\": %.6f, \"sums_12_59_largest\": %.6f",
              k4.mean, k4.largest, rig.mean, rig.largest);
  for (const int m : {13, 20, 40}) PrintRegions(m);
  std::printf("}\n");
}

}  // namespace
}  // namespace rigcal::graph

int main() {
  rigcal::graph::Run();
  return 0;
}
