#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/motion_start.h"
#include "server/calib/motion/stream_motion.h"
#include "server/math/statistics.h"
#include "tests/unit/calib/virtual_motion.h"

namespace rigcal::calib {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180;
constexpr PoseNoise kNoise{0.0003, 0.05 * kDegree};

Vector6d ErrorOf(const Se3& truth, const Se3& estimate) { return (truth.Inverse() * estimate).Log(); }

bool Has(const std::vector<Diagnosis>& notes, const std::string& code) {
  return std::any_of(notes.begin(), notes.end(), [&](const Diagnosis& note) { return note.code == code; });
}

TEST(ClosedForm, IsExactOnExactMotion) {
  const VirtualBody body = Driven(Drive::kFree, 12, 0.3, 1);
  std::vector<Se3> b;
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) b.push_back(body.WorldB(k));
  const ClosedForm closed = ClosedFormOf(body.T_world_a, b);
  EXPECT_LT(ErrorOf(body.X, closed.X).norm(), 1e-9);
  EXPECT_LT(ErrorOf(body.Z, closed.Z).norm(), 1e-9);
}

TEST(HandEye, IsExactOnExactMotion) {
  const VirtualBody body = Driven(Drive::kFree, 12, 0.3, 2);
  const auto result = EstimateHandEye(Tracked(body, {}, {}, 1));
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_LT(ErrorOf(body.X, result->estimate.T_a_b).norm(), 1e-7);
  EXPECT_LT(ErrorOf(body.Z, result->estimate.T_world_a_world_b).norm(), 1e-7);
}

// Numerical derivatives of the whole cost, away from zero residuals: at the minimum none is left.
TEST(HandEye, StandsAtTheMinimum) {
  const VirtualBody body = Driven(Drive::kFree, 12, 0.3, 3);
  auto work = CollectMotion(Tracked(body, {0.01, 0.01}, {0.02, 0.01}, 3));
  ASSERT_TRUE(work);
  ASSERT_TRUE(FitMotion(Tracked(body, {0.01, 0.01}, {0.02, 0.01}, 3), *work));
  const auto cost_at = [&](const Se3& X, const Se3& Z) {
    double cost = 0;
    MotionState state = work->state;
    state.X = X, state.Z = Z;
    for (std::size_t k = 0; k < work->captures.size(); ++k) {
      const Vector6d e_a = (work->problem.a.poses[k].T_world_sensor.Inverse() * state.T_world_a[k]).Log();
      const Vector6d e_b = ((Z * work->problem.b.poses[k].T_world_sensor).Inverse() * state.T_world_a[k] * X).Log();
      cost += e_a.dot(work->problem.a.poses[k].covariance.inverse() * e_a) +
              e_b.dot(work->problem.b.poses[k].covariance.inverse() * e_b);
    }
    return cost;
  };
  const double least = cost_at(work->state.X, work->state.Z);
  EXPECT_GT(least, 10);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 1e-4 * Vector6d::Unit(i);
    const double x = cost_at(work->state.X * Se3::Exp(step), work->state.Z) -
                     cost_at(work->state.X * Se3::Exp(-step), work->state.Z);
    const double z = cost_at(work->state.X, work->state.Z * Se3::Exp(step)) -
                     cost_at(work->state.X, work->state.Z * Se3::Exp(-step));
    EXPECT_NEAR(x / 2e-4, 0, 1e-2) << i;
    EXPECT_NEAR(z / 2e-4, 0, 1e-2) << i;
  }
}

TEST(HandEye, FindsTheNoiseOfEachSide) {
  double a_m = 0, b_m = 0, sum_rad2 = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const VirtualBody body = Driven(Drive::kFree, 60, 0.3, seed);
    const auto result = EstimateHandEye(Tracked(body, {0.001, 0.0002}, {0.004, 0.002}, seed));
    ASSERT_TRUE(result);
    a_m += result->estimate.noise_a.translation_m / 10;
    b_m += result->estimate.noise_b.translation_m / 10;
    sum_rad2 +=
        (std::pow(result->estimate.noise_a.rotation_rad, 2) + std::pow(result->estimate.noise_b.rotation_rad, 2)) / 10;
  }
  // Whose translation noise it is shows only through the lever arm; together they are well known.
  EXPECT_NEAR(std::hypot(a_m, b_m), std::hypot(0.001, 0.004), 0.0008);
  EXPECT_NEAR(std::sqrt(sum_rad2), std::hypot(0.0002, 0.002), 0.0003);
}

TEST(HandEye, DirectionsOfTheEdgeAgree) {
  const VirtualBody body = Driven(Drive::kFree, 20, 0.3, 4);
  HandEyeProblem problem = Tracked(body, kNoise, kNoise, 4);
  const auto forward = EstimateHandEye(problem);
  std::swap(problem.a, problem.b);
  const auto backward = EstimateHandEye(problem);
  ASSERT_TRUE(forward && backward);
  EXPECT_LT(ErrorOf(forward->estimate.T_a_b, backward->estimate.T_a_b.Inverse()).norm(), 2e-6);
  const Matrix6d there = forward->uncertainty.covariance,
                 back = InverseCovariance(backward->estimate.T_a_b, backward->uncertainty.covariance);
  EXPECT_LT((there - back).norm(), 0.02 * there.norm());
}

struct Weak {
  Drive drive;
  double ratio;  // of the tilt to the noise of one side
  int rank;
  const char* code;
};
class WeakMotion : public testing::TestWithParam<Weak> {};

// Four sigma of 8 x 6 numbers with 39 degrees of freedom fail by chance once in 80 runs, six once in 30,000; the seeds
// are fixed.
TEST_P(WeakMotion, ClaimsOnlyWhatItKnows) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const VirtualBody body = Driven(GetParam().drive, 40, GetParam().ratio * kNoise.rotation_rad, seed);
    HandEyeProblem problem = Tracked(body, kNoise, kNoise, 700 + seed);
    if (GetParam().drive != Drive::kFloor) problem.T_a_b_nominal = body.X * Se3::Exp(0.002 * Vector6d::Ones());
    const auto result = EstimateHandEye(problem);
    ASSERT_TRUE(result) << result.error().what;
    EXPECT_EQ(result->uncertainty.rank, GetParam().rank);
    EXPECT_TRUE(Validate(result->uncertainty)) << Validate(result->uncertainty).error().what;
    EXPECT_LT(WorstSigmas(body.X, result->estimate.T_a_b, result->uncertainty), 6);
    if (GetParam().rank == 6) continue;
    EXPECT_TRUE(Has(result->notes, GetParam().code));
    if (GetParam().drive == Drive::kNoTurns) continue;
    const Eigen::Vector3d axis =
        GetParam().drive == Drive::kStraight ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    EXPECT_GT(std::abs(result->estimate.reach.axis_a.dot(axis)), std::cos(2 * kDegree));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tilts, WeakMotion,
    testing::Values(Weak{Drive::kFloor, 0, 5, "planar_motion"}, Weak{Drive::kFloor, 1, 5, "planar_motion"},
                    Weak{Drive::kFloor, 2, 5, "planar_motion"}, Weak{Drive::kFloor, 10, 6, ""},
                    Weak{Drive::kOnTheSpot, 0, 4, "turning_on_the_spot"},
                    Weak{Drive::kOnTheSpot, 2, 4, "turning_on_the_spot"}, Weak{Drive::kOnTheSpot, 10, 6, ""},
                    Weak{Drive::kNoTurns, 0, 3, "pure_translation"}, Weak{Drive::kStraight, 0, 2, "straight_line"}));

TEST(HandEye, NothingMovedIsADiagnosis) {
  const auto result = EstimateHandEye(Tracked(Driven(Drive::kStill, 10, 0, 1), kNoise, kNoise, 1));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().code, testing::AnyOf("no_motion", "too_few_captures"));
}

TEST(HandEye, PositionsInMillimetresAreAskedAbout) {
  HandEyeProblem problem = Tracked(Driven(Drive::kFree, 20, 0, 1), kNoise, kNoise, 1);
  for (TimedPose& pose : problem.b.poses) pose.T_world_body.p_m *= 1000;
  const Edge edge = EstimateHandEyeEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.front().code, "positions_in_millimetres");
  EXPECT_GT(edge.figures.at("positions_step_b_m"), 100);
}

TEST(HandEye, NamesTheAxisInItsEdge) {
  const Edge edge = EstimateHandEyeEdge(Tracked(Driven(Drive::kFloor, 30, 0, 1), kNoise, kNoise, 1));
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_EQ(edge.uncertainty.rank, 5);
  EXPECT_NEAR(std::abs(edge.figures.at("axis_a_z_ratio")), 1, 1e-3);
  EXPECT_THAT(edge.diagnoses.front().what, HasSubstr("about one axis only"));
  Edge whole = edge;
  whole.id = EdgeId(std::string(64, 'a'));
  whole.robot = RobotId("r");
  EXPECT_TRUE(Validate(whole)) << Validate(whole).error().what;
}

TEST(HandEye, LeavesOutWhatContradicts) {
  const VirtualBody body = Driven(Drive::kFree, 30, 0.3, 5);
  HandEyeProblem problem = Tracked(body, kNoise, kNoise, 5);
  const auto clean = EstimateHandEye(problem);
  for (const std::size_t k : {3U, 11U, 12U, 20U, 28U})
    std::swap(problem.a.poses[k].T_world_body, problem.a.poses[k - 1].T_world_body);
  const Edge edge = EstimateHandEyeEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(Has(edge.diagnoses, "inconsistent_captures"));
  const Vector6d moved = ErrorOf(clean->estimate.T_a_b, edge.T_a_b);
  EXPECT_LT(moved.head<3>().norm(), 0.001);
  EXPECT_LT(moved.tail<3>().norm(), 0.001);
  EXPECT_FALSE(edge.captures[3].used);
  EXPECT_TRUE(edge.captures[4].used);
}

TEST(HandEye, DoesNotCountRepeatedCaptures) {
  VirtualBody body = Driven(Drive::kFree, 12, 0.3, 6);
  const HandEyeProblem once = Tracked(body, kNoise, kNoise, 6);
  HandEyeProblem twice = once;
  for (auto* side : {&twice.a, &twice.b})
    for (std::size_t k = 0; k < 12; ++k) {
      side->poses.push_back(side->poses[k]);
      side->poses.back().capture = CaptureId("copy" + std::to_string(k));
    }
  const auto a = EstimateHandEye(once), b = EstimateHandEye(twice);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(b->estimate.captures, 12U);
  EXPECT_EQ(a->uncertainty.Omega, b->uncertainty.Omega);
}

TEST(HandEye, TooFewAreADiagnosis) {
  const auto result = EstimateHandEye(Tracked(Driven(Drive::kFree, 3, 0.3, 1), kNoise, kNoise, 1));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, "too_few_captures");
}

TEST(HandEye, AFailedEdgeCountsWhatItsFilesHold) {
  const VirtualView view;
  HandEyeProblem problem = TrackerAndCamera(Looking(view, 12, 0.25, 0.15, 5), view, {0.0002, 0.0009}, 0, 5);
  problem.a.poses.resize(3);
  const Edge edge = EstimateHandEyeEdge(problem);
  ASSERT_EQ(edge.diagnoses.front().code, "too_few_captures");
  EXPECT_EQ(edge.figures.at("captures_total"), 12);
  EXPECT_EQ(edge.figures.at("files_a"), 3);
  EXPECT_EQ(edge.figures.at("files_with_board_a"), 3);
  EXPECT_EQ(edge.figures.at("files_b"), 12);
}

TEST(HandEye, TurnedBoardsGiveTheSameResult) {
  VirtualView view;
  view.board.cols = 9, view.board.rows = 7;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const VirtualBody body = Looking(view, 25, 0.25, 0.09, seed);
    const auto plain = EstimateHandEye(TrackerAndCamera(body, view, {0.0002, 0.0009}, 0, seed));
    const auto turned = EstimateHandEye(TrackerAndCamera(body, view, {0.0002, 0.0009}, 0.3, seed));
    ASSERT_TRUE(plain && turned);
    EXPECT_LT(ErrorOf(plain->estimate.T_a_b, turned->estimate.T_a_b).norm(), 1e-6);
    EXPECT_EQ(plain->uncertainty.rank, turned->uncertainty.rank);
    EXPECT_LT((plain->uncertainty.covariance - turned->uncertainty.covariance).norm(),
              1e-4 * plain->uncertainty.covariance.norm());
  }
}

TEST(HandEye, SmallFrontalBoardsAreHeldApart) {
  VirtualView view;
  view.board.cols = 9, view.board.rows = 7, view.board.square_m = 0.012;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const VirtualBody body = Looking(view, 40, 0.25, 0.06, seed);
    const auto result = EstimateHandEye(TrackerAndCamera(body, view, {0.0002, 0.0009}, 0.3, seed));
    ASSERT_TRUE(result) << result.error().what;
    EXPECT_LT(WorstSigmas(body.X, result->estimate.T_a_b, result->uncertainty), 6);
    EXPECT_GE(result->estimate.captures, 38U);
  }
}

TEST(HandEye, TwoCamerasWithTheirIntrinsicsEstimated) {
  const VirtualView view;
  const VirtualBody body = Looking(view, 30, 0.25, 0.15, 3);
  const Edge edge = EstimateHandEyeEdge(TwoCameras(body, view, false, 3));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
  EXPECT_EQ(edge.method, "non_overlapping");
  EXPECT_LT(WorstSigmas(body.X, edge.T_a_b, edge.uncertainty), 6);
  EXPECT_LT(ErrorOf(body.X, edge.T_a_b).head<3>().norm(), 0.004);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kJackknife);
}

TEST(HandEye, GivenConstantsGoIntoSigma) {
  const VirtualView view;
  const VirtualBody body = Looking(view, 30, 0.25, 0.15, 4);
  HandEyeProblem problem = TwoCameras(body, view, true, 4);
  const auto exact = EstimateHandEye(problem);
  problem.a.board->square_sigma_m = 0.001 * problem.a.board->square_m;
  // So good that the views do not refine them by much.
  problem.b.sensor.intrinsics_sigma = std::vector<double>{0.01, 0.01, 0.01, 0.01, 0, 0, 0, 0, 0};
  const auto given = EstimateHandEye(problem);
  ASSERT_TRUE(exact && given);
  ASSERT_EQ(given->uncertainty.contributions.size(), 2U);
  EXPECT_THAT(given->uncertainty.contributions[0].name, HasSubstr("board"));
  const Matrix6d added = given->uncertainty.covariance - exact->uncertainty.covariance;
  const Matrix6d said = given->uncertainty.contributions[0].covariance + given->uncertainty.contributions[1].covariance;
  EXPECT_LT((added - said).norm(), 0.02 * said.norm());
  // The first contribution by its definition: all of the problem with a board 0.1 % larger, its noise found anew.
  HandEyeProblem larger = TwoCameras(body, view, true, 4);
  larger.a.board->square_m *= 1.001;
  const Vector6d shift = ErrorOf(exact->estimate.T_a_b, EstimateHandEye(larger)->estimate.T_a_b);
  const Matrix6d expected = shift * shift.transpose();
  EXPECT_LT((given->uncertainty.contributions[0].covariance - expected).norm(), 0.3 * expected.norm());
}

TEST(HandEye, StreamsOfUnalignedClocks) {
  const VirtualBody body = Driven(Drive::kFree, 1, 0.3, 7);
  const Edge edge = EstimateHandEyeEdge(Streamed(body, {0.002, 0.002}, 40, -77.1234, 7));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
  EXPECT_LT(WorstSigmas(body.X, edge.T_a_b, edge.uncertainty), 6);
  EXPECT_NEAR(edge.figures.at("clock_offset_s"), -77.1234, 0.001);
  EXPECT_GT(edge.figures.at("clock_offset_sigma_s"), 0);
  EXPECT_LT(edge.figures.at("clock_offset_sigma_s"), 0.001);
}

TEST(HandEye, StreamsWithNothingInCommonAreADiagnosis) {
  HandEyeProblem problem = Streamed(Driven(Drive::kFree, 1, 0.3, 8), {0.002, 0.002}, 40, 0, 8);
  problem.b.poses = Streamed(Driven(Drive::kFree, 1, 0.3, 9), {0.002, 0.002}, 40, 0, 9).b.poses;
  const Edge edge = EstimateHandEyeEdge(problem);
  EXPECT_EQ(edge.state, EdgeState::kFailed);
  problem.b.poses.resize(1);
  EXPECT_EQ(EstimateHandEyeEdge(problem).diagnoses.front().code, "no_common_time");
}

HandEyeProblem Cut(HandEyeProblem streams, std::size_t rows_a, std::size_t step_a, std::size_t rows_b) {
  PoseTable a;
  for (std::size_t i = 0; i < rows_a; ++i) a.push_back(streams.a.poses[i * step_a]);
  streams.a.poses = std::move(a);
  streams.b.poses.resize(rows_b);
  return streams;
}

// The number that is needed is the one that was the limit.
TEST(HandEye, StreamsWithFewPosesInCommonSayHowManyAreNeeded) {
  const HandEyeProblem streams = Streamed(Driven(Drive::kFree, 1, 0.3, 7), {0.0005, 0.0005}, 40, 0, 7);
  const Edge edge = EstimateHandEyeEdge(Cut(streams, 32, 10, 90));  // ten poses a second, for three seconds
  ASSERT_EQ(edge.diagnoses.front().code, "too_few_poses") << edge.diagnoses.front().what;
  EXPECT_THAT(edge.diagnoses.front().what,
              testing::ContainsRegex("at only [1-3][0-9] places of their path.*; at least 40 are needed"));
  EXPECT_THAT(edge.diagnoses.front().cure, HasSubstr("half a minute or more"));
  const Diagnosis slow = TooFewSamples(streams, 28, 40, 56);
  EXPECT_THAT(slow.what, HasSubstr("at only 28 places of their path, in the 56.0 s that both recorded"));
  EXPECT_THAT(slow.cure, HasSubstr("Record ten or more poses a second"));
  EXPECT_EQ(slow.cure.find("half a minute"), std::string::npos);
}

// A recording of 56 s is not told to be of half a minute.
TEST(HandEye, StreamsThatDoNotAgreeAreToldWhatIsWrongWithThem) {
  const HandEyeProblem streams = Streamed(Driven(Drive::kFree, 1, 0.3, 8), {0.0005, 0.0005}, 56, 0, 8);
  const auto said = [](const HandEyeProblem& problem) {
    const Edge edge = EstimateHandEyeEdge(problem);
    EXPECT_EQ(edge.diagnoses.front().code, "no_common_time") << edge.diagnoses.front().what;
    return edge.diagnoses.front();
  };
  HandEyeProblem still = streams;
  for (TimedPose& row : still.b.poses) row.T_world_body = streams.b.poses.front().T_world_body;
  EXPECT_THAT(said(still).what, HasSubstr("56.0 s and 53.7 s long, turned by up to "));
  EXPECT_THAT(said(still).cure, testing::StartsWith("Turn the robot to and fro, by 20 degrees"));
  EXPECT_THAT(said(Cut(streams, 100, 1, 100)).cure, HasSubstr("half a minute or more"));
  const Diagnosis others = NoCommonTime(streams, 0.12);
  EXPECT_THAT(others.what, HasSubstr("best correlation 0.12; "));
  EXPECT_THAT(others.cure, testing::StartsWith("Check that both are of the same drive"));
}

TEST(HandEye, CapturesThatRepeatAreNotCalledMissing) {
  const VirtualBody body = Driven(Drive::kStill, 28, 0, 3);
  const Edge edge = EstimateHandEyeEdge(Tracked(body, {}, {}, 3));
  ASSERT_EQ(edge.diagnoses.front().code, "too_few_captures");
  EXPECT_THAT(edge.diagnoses.front().what,
              HasSubstr("have a pose each in 28 captures, but 27 of them repeat the pose of another; at least 4 "
                        "different ones are needed"));
}

TEST(HandEye, GivesTheSameBytesTwice) {
  const VirtualView view;
  const HandEyeProblem problem = TwoCameras(Looking(view, 20, 0.25, 0.15, 5), view, false, 5);
  const Edge one = EstimateHandEyeEdge(problem), two = EstimateHandEyeEdge(problem);
  EXPECT_EQ(one.T_a_b.p_m, two.T_a_b.p_m);
  EXPECT_EQ(one.T_a_b.q.coeffs(), two.T_a_b.q.coeffs());
  EXPECT_EQ(one.uncertainty.Omega, two.uncertainty.Omega);
}

}  // namespace
}  // namespace rigcal::calib
