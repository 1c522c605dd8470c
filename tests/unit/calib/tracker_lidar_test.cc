#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "server/calib/tracker_lidar/tracker_lidar_work.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_planes.h"

namespace rigcal::calib {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180;
constexpr PoseNoise kTracker{0.0002, 0.05 * kDegree};

VirtualPlates Noisy() {
  VirtualPlates plates = FourPlates();
  plates.range_sigma_m = 0.02;
  plates.tracker = kTracker;
  return plates;
}

Vector6d ErrorOf(const Se3& truth, const Se3& estimate) { return (truth.Inverse() * estimate).Log(); }

const Diagnosis* Find(const std::vector<Diagnosis>& notes, const std::string& code) {
  const auto at = std::find_if(notes.begin(), notes.end(), [&](const Diagnosis& note) { return note.code == code; });
  return at == notes.end() ? nullptr : &*at;
}

std::string CodeOf(const TrackerLidarProblem& problem) {
  const Edge edge = EstimateTrackerLidarEdge(problem);
  EXPECT_TRUE(edge.state == EdgeState::kFailed || Validate(edge.uncertainty));
  return edge.state == EdgeState::kGood ? "good" : edge.diagnoses.front().code;
}

TEST(StaticPlanes, DerivativesAreThoseOfThePlane) {
  const VirtualBody body = Driven(Drive::kFree, 3, 0.3, 5);
  const WorldPlane plane{Eigen::Vector3d(0.3, -0.8, 0.5).normalized(), 1.7};
  constexpr double kStep = 1e-6, kBias_m = 0.04;
  const Se3 &T = body.T_world_a[1], &X = body.X;
  const SightingJacobian at = JacobianAt(T, X, plane, kBias_m);
  for (int i = 0; i < 6; ++i) {
    const Se3 plus = Se3::Exp(kStep * Vector6d::Unit(i)), minus = Se3::Exp(-kStep * Vector6d::Unit(i));
    const Vector7d by_lidar =
        (PlaneInLidar(T, X * plus, plane, kBias_m) - PlaneInLidar(T, X * minus, plane, kBias_m)) / (2 * kStep);
    const Vector7d by_body =
        (PlaneInLidar(T * plus, X, plane, kBias_m) - PlaneInLidar(T * minus, X, plane, kBias_m)) / (2 * kStep);
    EXPECT_LT((at.by_lidar.col(i) - by_lidar).norm(), 1e-8) << i;
    EXPECT_LT((at.by_body.col(i) - by_body).norm(), 1e-8) << i;
  }
  // A point of the plane, seen by the lidar, is on it.
  const Eigen::Vector3d p = (T * X).Inverse() * Eigen::Vector3d(plane.distance_m * plane.normal);
  EXPECT_NEAR(at.g.head<3>().dot(p) + at.g[6], 0, 1e-12);
}

TEST(TrackerLidar, IsExactOnExactPoses) {
  for (const bool tracker_is_a : {true, false}) {
    const VirtualBody body = Driven(Drive::kFree, 12, 0.3, 2);
    TrackerLidarProblem problem = Scanned(body, FourPlates(), 1);
    problem.tracker_is_a = tracker_is_a;
    const Edge edge = EstimateTrackerLidarEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    EXPECT_EQ(edge.method, "tracker_lidar");
    EXPECT_EQ(edge.frame_a.str(), tracker_is_a ? "body" : "top");
    EXPECT_EQ(edge.frame_b.str(), tracker_is_a ? "top" : "body");
    EXPECT_LT(ErrorOf(tracker_is_a ? body.X : body.X.Inverse(), edge.T_a_b).norm(), 1e-6);  // points are floats
    EXPECT_EQ(edge.uncertainty.rank, 6);
    EXPECT_EQ(edge.figures.at("planes_used"), 4);
  }
}

TEST(TrackerLidar, FindsTheBoardsInTheWorld) {
  const VirtualPlates plates = FourPlates();
  const VirtualBody body = Driven(Drive::kFree, 12, 0.3, 2);
  const auto result = EstimateTrackerLidar(Scanned(body, plates, 1));
  ASSERT_TRUE(result);
  for (const Se3& T_world_plate : plates.T_world_plate) {
    const Eigen::Vector3d normal = -T_world_plate.R().col(2);
    EXPECT_TRUE(
        std::any_of(result->estimate.boards.begin(), result->estimate.boards.end(), [&](const WorldPlane& board) {
          return (board.normal - normal).norm() < 1e-6 &&
                 std::abs(board.distance_m - normal.dot(T_world_plate.p_m)) < 1e-6;
        }));
  }
}

// 240 squares of whitened errors against the chi-square of as many degrees of freedom at odds of 1e-7 on either side,
// and likewise against the bound, which comes from every point by numerical derivatives.
TEST(TrackerLidar, ErrsAsItSaysAndAsLittleAsCanBe) {
  constexpr unsigned kSeeds = 40;
  double squares = 0, of_model = 0, of_bound = 0;
  int covered = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const VirtualBody body = Driven(Drive::kFree, 40, 0.3, seed);
    const auto result = EstimateTrackerLidar(Scanned(body, Noisy(), 100 + seed));
    ASSERT_TRUE(result) << result.error().what;
    ASSERT_EQ(result->uncertainty.rank, 6);
    const Vector6d e = (result->estimate.T_body_lidar.Inverse() * body.X).Log();
    squares += e.dot(result->uncertainty.Omega * e);
    of_model += e.dot(result->estimate.information * e);
    of_bound += e.dot(BoundOf(body, Noisy()).llt().solve(e));
    covered += e.dot(result->uncertainty.Omega * e) <= HotellingLimit(result->uncertainty.dof + 1) ? 1 : 0;
  }
  const double low = ChiSquareQuantile(1e-7, 6 * kSeeds), high = ChiSquareQuantile(1 - 1e-7, 6 * kSeeds);
  // The jackknife's share of the covariance is itself uncertain, with 39 degrees of freedom: 1.2 times as much.
  EXPECT_GT(squares, low);
  EXPECT_LT(squares, 1.2 * high);
  EXPECT_GT(of_model, low);
  EXPECT_LT(of_model, high);
  EXPECT_GT(of_bound, low);
  EXPECT_LT(of_bound, high);
  EXPECT_GE(covered, 28);  // of 38 expected: 7 sigma
  std::printf("mean square in sigmas %.3f, of the model %.3f, of the bound %.3f, covered %d of 40\n",
              squares / (6 * kSeeds), of_model / (6 * kSeeds), of_bound / (6 * kSeeds), covered);
}

struct Weak {
  Drive drive;
  double ratio;  // of the tilt to the tracker's noise
  int rank;
  const char* code;
};
class WeakTrackerMotion : public testing::TestWithParam<Weak> {};

// Six sigma of 8 x 6 numbers with 39 degrees of freedom fail by chance once in 30,000 runs; the seeds are fixed.
TEST_P(WeakTrackerMotion, ClaimsOnlyWhatItKnows) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const VirtualBody body = Driven(GetParam().drive, 40, GetParam().ratio * kTracker.rotation_rad, seed);
    TrackerLidarProblem problem = Scanned(body, Noisy(), 700 + seed);
    problem.tracker_is_a = seed % 2 == 0;
    const auto result = EstimateTrackerLidar(problem);
    ASSERT_TRUE(result) << result.error().what;
    EXPECT_EQ(result->uncertainty.rank, GetParam().rank);
    EXPECT_TRUE(Validate(result->uncertainty)) << Validate(result->uncertainty).error().what;
    const Se3& X = result->estimate.T_body_lidar;
    EXPECT_LT(problem.tracker_is_a ? WorstSigmas(body.X, X, result->uncertainty)
                                   : WorstSigmas(body.X.Inverse(), X.Inverse(), result->uncertainty),
              6);
    EXPECT_EQ(Find(result->notes, GetParam().code) != nullptr, GetParam().rank < 6);
    if (GetParam().rank != 5) continue;
    const OpenAxes axes = AxesOf(result->estimate.reach, X);
    ASSERT_EQ(axes.positions.size(), 1u);
    EXPECT_GT(std::abs(axes.positions[0].z()), std::cos(2 * kDegree));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tilts, WeakTrackerMotion,
    testing::Values(Weak{Drive::kFloor, 0, 5, "planar_motion"}, Weak{Drive::kFloor, 1, 5, "planar_motion"},
                    Weak{Drive::kFloor, 0.5, 5, "planar_motion"}, Weak{Drive::kFloor, 10, 6, ""},
                    Weak{Drive::kOnTheSpot, 0, 4, "turning_on_the_spot"},
                    Weak{Drive::kOnTheSpot, 1, 4, "turning_on_the_spot"}, Weak{Drive::kOnTheSpot, 10, 6, ""},
                    Weak{Drive::kNoTurns, 0, 3, "pure_translation"}, Weak{Drive::kStraight, 0, 2, "straight_line"}));

// A tracker far worse than is expected of one: its noise is found, and what a level drive leaves open stays so.
TEST(TrackerLidar, FindsANoisyTracker) {
  for (const Drive drive : {Drive::kFree, Drive::kFloor, Drive::kOnTheSpot})
    for (unsigned seed = 0; seed < 3; ++seed) {
      VirtualPlates plates = Noisy();
      plates.tracker = {0.005, 0.01};
      const VirtualBody body = Driven(drive, 40, 0, 100 + seed);
      const auto result = EstimateTrackerLidar(Scanned(body, plates, 300 + seed));
      ASSERT_TRUE(result) << result.error().what;
      EXPECT_EQ(result->uncertainty.rank, drive == Drive::kFree ? 6 : drive == Drive::kFloor ? 5 : 4);
      EXPECT_LT(WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty), 6);
      EXPECT_NEAR(result->estimate.noise_m, 0.005, 0.0025);
      EXPECT_NEAR(result->estimate.noise_rad, 0.01, 0.003);
    }
}

// One board does if the body turns to all sides: its normal comes from everywhere.
TEST(TrackerLidar, OneBoardIsEnoughForABodyThatTurns) {
  VirtualPlates plates = Noisy();
  plates.T_world_plate.resize(1);
  const VirtualBody body = Driven(Drive::kFree, 40, 0.3, 1);
  const auto result = EstimateTrackerLidar(Scanned(body, plates, 1));
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_EQ(result->uncertainty.rank, 6);
  EXPECT_LT(WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty), 6);
}

// Under a level ceiling board a body that drives on the floor learns its height over nothing, and no heading.
TEST(TrackerLidar, SaysThatBoardsFaceOneWay) {
  VirtualPlates plates = Noisy();
  Se3 above;
  above.p_m = {0.2, -0.1, 3.0};
  plates.T_world_plate = {above};
  const auto result = EstimateTrackerLidar(Scanned(Driven(Drive::kFloor, 40, 0, 1), plates, 1));
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_EQ(result->uncertainty.rank, 2);
  const Diagnosis* note = Find(result->notes, "few_planes");
  ASSERT_NE(note, nullptr);
  EXPECT_THAT(note->what, HasSubstr("where top is from body"));
  EXPECT_THAT(note->what, HasSubstr("the 1 board that top sees"));
}

TEST(TrackerLidar, HoldsWhatIsOpenWhereTheDrawingHasIt) {
  const VirtualBody body = Driven(Drive::kFloor, 40, 0, 3);
  TrackerLidarProblem problem = Scanned(body, Noisy(), 3);
  const auto result = EstimateTrackerLidar(problem);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->estimate.T_body_lidar.p_m.z(), problem.T_body_lidar_nominal->p_m.z(), 0.003);
  problem.T_body_lidar_nominal.reset();
  const auto undrawn = EstimateTrackerLidar(problem);
  ASSERT_TRUE(undrawn) << undrawn.error().what;
  EXPECT_NEAR(undrawn->estimate.T_body_lidar.p_m.z(), 0, 0.003);
  EXPECT_LT((undrawn->estimate.T_body_lidar.p_m - result->estimate.T_body_lidar.p_m).head<2>().norm(), 0.003);
}

TEST(TrackerLidar, FindsItsBoardsAmongOtherThings) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const bool nominal : {true, false}) {
      VirtualPlates plates = Noisy();
      plates.decoys = true;
      plates.nominal = nominal;
      const VirtualBody body = Driven(Drive::kFree, 30, 0.3, seed);
      const auto result = EstimateTrackerLidar(Scanned(body, plates, 50 + seed));
      ASSERT_TRUE(result) << result.error().what;
      EXPECT_EQ(result->uncertainty.rank, 6);
      EXPECT_LT(WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty), 6);
    }
}

TEST(TrackerLidar, OvercomesAWrongDrawing) {
  const VirtualBody body = Driven(Drive::kFree, 30, 0.3, 6);
  TrackerLidarProblem problem = Scanned(body, Noisy(), 6);
  problem.T_body_lidar_nominal = body.X * Se3::Exp((Vector6d() << 0.1, 0, 0, 0, 0, 1.57).finished());
  const auto result = EstimateTrackerLidar(problem);
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_LT(WorstSigmas(body.X, result->estimate.T_body_lidar, result->uncertainty), 6);
}

TEST(TrackerLidar, LeavesOutWhatContradicts) {
  const VirtualBody body = Driven(Drive::kFree, 30, 0.3, 7);
  TrackerLidarProblem problem = Scanned(body, Noisy(), 7);
  std::swap(problem.captures[3].T_world_body, problem.captures[11].T_world_body);
  const Edge edge = EstimateTrackerLidarEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  const Diagnosis* note = Find(edge.diagnoses, "inconsistent_captures");
  ASSERT_NE(note, nullptr);
  EXPECT_THAT(note->what, HasSubstr("003, 011"));
  EXPECT_FALSE(edge.captures[3].used);
  EXPECT_LT(WorstSigmas(body.X, edge.T_a_b, edge.uncertainty), 6);
}

TEST(TrackerLidar, RefusesWhatIsNoVisit) {
  const VirtualBody body = Driven(Drive::kFree, 20, 0.3, 8);
  VirtualPlates plates = Noisy();
  plates.boards_move = true;
  for (const bool nominal : {true, false}) {
    plates.nominal = nominal;
    EXPECT_EQ(CodeOf(Scanned(body, plates, 8)), "no_agreement");
  }
  TrackerLidarProblem few = Scanned(Driven(Drive::kFree, 3, 0.3, 8), Noisy(), 8);
  EXPECT_EQ(CodeOf(few), "too_few_captures");
  plates = Noisy();
  plates.tracker = {0.12, 0.001};  // markers that wobble
  EXPECT_EQ(CodeOf(Scanned(body, plates, 8)), "high_residual");
  EXPECT_EQ(CodeOf(Scanned(Driven(Drive::kStill, 20, 0, 8), FourPlates(), 8)), "too_few_captures");
  EXPECT_EQ(CodeOf(Scanned(Driven(Drive::kStill, 20, 0, 8), Noisy(), 8)), "no_motion");
  // Moved along one line, the lidar could be turned about it in any way.
  plates = Noisy();
  plates.nominal = false;
  EXPECT_EQ(CodeOf(Scanned(Driven(Drive::kStraight, 20, 0, 8), plates, 8)), "ambiguous_board");
  EXPECT_EQ(CodeOf({}), "too_few_captures");
}

TEST(TrackerLidar, TellsCloudsWithoutBoards) {
  TrackerLidarProblem problem = Scanned(Driven(Drive::kFree, 20, 0.3, 9), Noisy(), 9);
  CloudView empty;
  empty.why_not = "the file ends in the middle";
  problem.captures[2].clouds = {empty};
  empty.points = 900;
  empty.why_not = "no flat patch of the plate's size";
  problem.captures[5].clouds = {empty};
  problem.captures[6].T_world_body.reset();
  problem.captures[7].clouds.clear();
  const Edge edge = EstimateTrackerLidarEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_THAT(Find(edge.diagnoses, "cloud_unreadable")->what, HasSubstr("002"));
  EXPECT_THAT(Find(edge.diagnoses, "board_not_found_in_cloud")->what, HasSubstr("005"));
  EXPECT_THAT(edge.captures[6].note, HasSubstr("body has no pose"));
  EXPECT_THAT(edge.captures[7].note, HasSubstr("no cloud"));
  EXPECT_EQ(edge.figures.at("captures_used"), 16);
}

TEST(TrackerLidar, OrderOfCapturesDoesNotShow) {
  TrackerLidarProblem problem = Scanned(Driven(Drive::kFree, 20, 0.3, 10), Noisy(), 10);
  const Edge forward = EstimateTrackerLidarEdge(problem);
  std::reverse(problem.captures.begin(), problem.captures.end());
  const Edge backward = EstimateTrackerLidarEdge(problem);
  ASSERT_EQ(forward.state, EdgeState::kGood);
  EXPECT_EQ(ContentDigest(forward), ContentDigest(backward));
}

TEST(TrackerLidar, DirectionsOfTheEdgeAgree) {
  TrackerLidarProblem problem = Scanned(Driven(Drive::kFree, 20, 0.3, 11), Noisy(), 11);
  const Edge forward = EstimateTrackerLidarEdge(problem);
  problem.tracker_is_a = false;
  const Edge backward = EstimateTrackerLidarEdge(problem);
  EXPECT_LT(ErrorOf(forward.T_a_b, backward.T_a_b.Inverse()).norm(), 1e-12);
  const Matrix6d back = InverseCovariance(backward.T_a_b, backward.uncertainty.covariance);
  EXPECT_LT((forward.uncertainty.covariance - back).norm(), 1e-3 * back.norm());
}

TEST(TrackerLidar, AGivenRangeBiasIsAContribution) {
  VirtualPlates plates = Noisy();
  const VirtualBody body = Driven(Drive::kFree, 40, 0.3, 12);
  plates.range_bias_m = 0.02;
  TrackerLidarProblem problem = Scanned(body, plates, 12);
  EXPECT_NE(Find(EstimateTrackerLidarEdge(problem).diagnoses, "range_taken_as_exact"), nullptr);
  problem.lidar.range_bias_sigma_m = 0.02;
  const Edge edge = EstimateTrackerLidarEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  ASSERT_EQ(edge.uncertainty.contributions.size(), 2u);
  EXPECT_EQ(edge.uncertainty.contributions[0].name, "range bias of top");
  EXPECT_EQ(edge.uncertainty.contributions[1].name, "range biases of single beams of top");
  EXPECT_EQ(edge.uncertainty.contributions[1].shifts.size(), 60u);
  EXPECT_EQ(Find(edge.diagnoses, "range_taken_as_exact"), nullptr);
  EXPECT_LT(WorstSigmas(body.X, edge.T_a_b, edge.uncertainty), 6);
  problem.range_bias_m = 0.02;  // known: then it moves nothing
  const Edge corrected = EstimateTrackerLidarEdge(problem);
  EXPECT_LT(ErrorOf(body.X, corrected.T_a_b).head<3>().norm(), 0.004);
}

// Of all ranges at once the refinement knows by itself; groups of beams are points moved: together they are the same.
TEST(TrackerLidar, BeamsTogetherMoveThePoseAsABiasOfAllRanges) {
  TrackerLidarProblem problem = Scanned(Driven(Drive::kFree, 16, 0.3, 13), Noisy(), 13);
  problem.lidar.range_bias_sigma_m = 0.01;
  for (const bool tracker_is_a : {true, false}) {
    problem.tracker_is_a = tracker_is_a;
    const Edge edge = EstimateTrackerLidarEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood);
    ASSERT_EQ(edge.uncertainty.contributions.size(), 2u);
    const Vector6d all = edge.uncertainty.contributions[0].shifts.at(0);
    Vector6d sum = Vector6d::Zero();
    for (const Vector6d& beam : edge.uncertainty.contributions[1].shifts) sum += beam;
    EXPECT_GT(all.norm(), 1e-4);
    EXPECT_LT((sum - all).norm(), 0.05 * all.norm()) << sum.transpose() << "\n" << all.transpose();
    EXPECT_GT(edge.uncertainty.contributions[1].covariance.trace(), 1e-8);
  }
}

// Every beam is off by a constant of its own, the same in all captures.
TEST(TrackerLidar, AGivenRangeBiasSigmaCoversBeamsThatErrEachByItself) {
  constexpr unsigned kSeeds = 8;
  constexpr double kBias_m = 0.02, kBeam_rad = 1.5 * M_PI / 180;
  double squares = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const VirtualBody body = Driven(Drive::kFree, 16, 0.3, 800 + seed);
    TrackerLidarProblem problem = Scanned(body, Noisy(), 800 + seed);
    problem.tracker_is_a = seed % 2 == 0;
    problem.lidar.range_bias_sigma_m = kBias_m;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, kBias_m);
    std::map<int, double> bias_m;
    for (int beam = -60; beam < 60; ++beam) bias_m[beam] = normal(random);
    for (TrackerLidarCapture& capture : problem.captures)
      for (CloudView& cloud : capture.clouds)
        for (PlanePatch& patch : cloud.candidates)
          for (Eigen::Vector3f& p : patch.points_m) {
            const double elevation_rad = std::atan2(p.z(), std::hypot(p.x(), p.y()));
            p += static_cast<float>(bias_m[static_cast<int>(std::floor(elevation_rad / kBeam_rad))]) * p.normalized();
          }
    const Edge edge = EstimateTrackerLidarEdge(problem);
    ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
    const Vector6d error = ErrorOf(problem.tracker_is_a ? body.X : body.X.Inverse(), edge.T_a_b);
    squares += error.dot(edge.uncertainty.Omega * error) / 6 / kSeeds;
  }
  RecordProperty("mean_squared_ratio", std::to_string(squares));
  EXPECT_GT(squares, 0.05);
  EXPECT_LT(squares, 2.0);
}

}  // namespace
}  // namespace rigcal::calib
