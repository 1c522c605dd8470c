#include "server/calib/lidar_lidar/lidar_lidar.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/calib/lidar_lidar/ndt_fit.h"
#include "tests/unit/calib/virtual_room.h"

namespace rigcal::calib {
namespace {

constexpr double kDeg = M_PI / 180;

LidarLidarEstimate Solve(const LidarLidarProblem& problem) {
  const auto estimate = EstimateLidarLidar(problem, nullptr);
  EXPECT_TRUE(estimate) << estimate.error().what;
  return estimate ? *estimate : LidarLidarEstimate{};
}

Vector6d ErrorOf(const VirtualRoom& room, const Se3& T_a_b) { return (room.T_a_b.Inverse() * T_a_b).Log(); }

std::string CodeOf(const LidarLidarProblem& problem) {
  const auto estimate = EstimateLidarLidar(problem, nullptr);
  if (estimate) return "good";
  EXPECT_FALSE(estimate.error().cure.empty());
  return estimate.error().code;
}

void ExpectSameBits(const Edge& one, const Edge& two) {
  EXPECT_EQ(one.T_a_b.p_m, two.T_a_b.p_m);
  EXPECT_EQ(one.T_a_b.q.coeffs(), two.T_a_b.q.coeffs());
  EXPECT_EQ(one.uncertainty.Omega, two.uncertainty.Omega);
  EXPECT_EQ(one.figures, two.figures);
}

// The voxels' own error is what is left: below a millimetre where 20 mm of noise leave one or two.
TEST(LidarLidar, WithoutNoiseThePoseIsTheTruth) {
  VirtualRoom room;
  room.beams_a.noise_m = room.beams_b.noise_m = 0;
  const LidarLidarEstimate estimate = Solve(RecordedIn(room, 1, 3));
  const Vector6d error = ErrorOf(room, estimate.T_a_b);
  EXPECT_LT(error.head<3>().norm(), 0.002);
  EXPECT_LT(error.tail<3>().norm(), 0.05 * kDeg);
  EXPECT_LE(estimate.last_step, kNdtStepMax);
  EXPECT_EQ(estimate.agreeing_ratio, 1.0);
}

TEST(LidarLidar, NoiseLeavesMillimetresAndThePolishAgrees) {
  const VirtualRoom room;
  LidarLidarProblem problem = RecordedIn(room, 1, 5);
  const LidarLidarEstimate ndt = Solve(problem);
  problem.polish = true;
  const LidarLidarEstimate polished = Solve(problem);
  EXPECT_FALSE(ndt.polished);
  EXPECT_TRUE(polished.polished);
  EXPECT_EQ(ndt.T_a_b_polished.p_m, polished.T_a_b.p_m);
  for (const Se3& T : {ndt.T_a_b, polished.T_a_b}) {
    const Vector6d error = ErrorOf(room, T);
    EXPECT_LT(error.head<3>().norm(), 0.01);
    EXPECT_LT(error.tail<3>().norm(), 0.25 * kDeg);
  }
}

// Only what was asked for is marked; how far the polish moves the pose is told in either case, and goes into sigma.
TEST(LidarLidar, APolishedPoseSaysSoAndByHowMuch) {
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 1, 5);
  const Edge ndt = EstimateLidarLidarEdge(problem);
  problem.polish = true;
  const Edge polished = EstimateLidarLidarEdge(problem);
  ASSERT_TRUE(ndt.state == EdgeState::kGood && polished.state == EdgeState::kGood);
  EXPECT_EQ(ndt.figures.at("polished_ratio"), 0);
  EXPECT_EQ(polished.figures.at("polished_ratio"), 1);
  for (const Diagnosis& note : ndt.diagnoses) EXPECT_NE(note.code, "polished");
  ASSERT_EQ(polished.diagnoses.size(), ndt.diagnoses.size() + 1);
  EXPECT_EQ(polished.diagnoses.back().code, "polished");
  const Vector6d moved = (ndt.T_a_b.Inverse() * polished.T_a_b).Log();
  EXPECT_GT(moved.head<3>().norm(), 1e-5);
  EXPECT_NEAR(polished.figures.at("polish_moved_m"), moved.head<3>().norm(), 1e-9);
  char text[32];
  std::snprintf(text, sizeof text, "moved it by %.1f mm", 1e3 * moved.head<3>().norm());
  EXPECT_NE(polished.diagnoses.back().what.find(text), std::string::npos) << polished.diagnoses.back().what;
  const auto trace_of_method = [](const Edge& edge) {
    return edge.uncertainty.contributions.back().covariance.trace();
  };
  EXPECT_GT(trace_of_method(polished), 1.5 * trace_of_method(ndt));
}

// The last stage is the polish; the one before it may be good.
TEST(LidarLidar, APolishThatDoesNotSettleCanBeLeftAway) {
  LidarLidarProblem problem;
  EXPECT_EQ(NotConverged(problem, 1e-3).cure.find("lidar_polish"), std::string::npos);
  problem.polish = true;
  EXPECT_NE(NotConverged(problem, 1e-3).cure.find("lidar_polish"), std::string::npos);
}

TEST(LidarLidar, AStartAtTheEdgeOfWhatIsAskedForIsEnough) {
  VirtualRoom room;
  LidarLidarProblem problem = RecordedIn(room, 1, 7);
  problem.T_a_b_nominal = room.T_a_b * Se3::Exp((Vector6d() << 0.2, -0.2, 0.2, 0.1, 0.1, -0.1).finished());
  const Vector6d error = ErrorOf(room, Solve(problem).T_a_b);
  EXPECT_LT(error.head<3>().norm(), 0.01);
  EXPECT_LT(error.tail<3>().norm(), 0.25 * kDeg);
}

TEST(LidarLidar, ExchangedLidarsGiveTheInverse) {
  const VirtualRoom room;
  const LidarLidarProblem problem = RecordedIn(room, 2, 11);
  const LidarLidarEstimate one = Solve(problem), other = Solve(Exchanged(problem));
  const Vector6d apart = (one.T_a_b * other.T_a_b).Log();
  EXPECT_LT(apart.norm(), 1e-6);  // the nominal poses are each other's inverse to rounding only
  const Matrix6d back = InverseCovariance(other.T_a_b, other.uncertainty.covariance);
  EXPECT_LT((back - one.uncertainty.covariance).norm(), 1e-3 * one.uncertainty.covariance.norm());
}

TEST(LidarLidar, ThreadsDoNotShow) {
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 2, 13);
  problem.polish = true;
  Edge one, two;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    one = EstimateLidarLidarEdge(problem);
  }
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    two = EstimateLidarLidarEdge(problem);
  }
  ASSERT_EQ(one.state, EdgeState::kGood);
  ExpectSameBits(one, two);
}

TEST(LidarLidar, SeveralCapturesAreCheckedOnEachLeftOut) {
  const VirtualRoom room;
  const Edge edge = EstimateLidarLidarEdge(RecordedIn(room, 5, 17));
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses[0].what;
  EXPECT_EQ(edge.method, "lidar_lidar");
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_EQ(edge.uncertainty.blocks.size(), 5u);
  EXPECT_EQ(edge.uncertainty.dof, 4);
  EXPECT_EQ(edge.captures.size(), 5u);
  EXPECT_GT(edge.figures.at("held_out_captures_D_ratio"), 0.99);
  EXPECT_LT(edge.figures.at("held_out_captures_E_l_m"), 0.003);
  EXPECT_LT(edge.figures.at("held_out_captures_E_l_rms_m"), 0.03);
  EXPECT_FALSE(edge.figures.contains("halves_differ_m"));
  EXPECT_TRUE(Validate(edge.uncertainty)) << Sentence(Validate(edge.uncertainty).error());
}

TEST(LidarLidar, OneCaptureIsNeverAJackknife) {
  const Edge edge = EstimateLidarLidarEdge(RecordedIn(VirtualRoom(), 1, 19));
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kModel);
  EXPECT_TRUE(edge.uncertainty.blocks.empty());
  EXPECT_GT(edge.uncertainty.dof, 20);
  EXPECT_TRUE(edge.figures.contains("held_out_halves_E_l_m"));
  EXPECT_EQ(edge.diagnoses.front().code, "single_capture");
  EXPECT_GT(std::sqrt(edge.uncertainty.covariance.diagonal().head<3>().minCoeff()), 1e-4);  // no micrometres
}

TEST(LidarLidar, ACorridorsAxisStaysUnknown) {
  VirtualRoom room;
  room.kind = RoomKind::kCorridor;
  room.start_m = 0.05, room.start_rad = 0.02;
  const LidarLidarProblem problem = RecordedIn(room, 1, 5);
  const Edge edge = EstimateLidarLidarEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses[0].what;
  EXPECT_EQ(edge.uncertainty.rank, 5);
  ASSERT_EQ(edge.diagnoses.front().code, "unknown_directions");
  EXPECT_NE(edge.diagnoses.front().what.find("shifts along"), std::string::npos);
  const Vector6d unknown = edge.uncertainty.unobservable_basis.col(0);
  EXPECT_GT(unknown.head<3>().norm(), 0.95);
  // Apart from it the pose is right, along it the nominal one.
  const Eigen::Vector3d axis = unknown.head<3>().normalized();
  const Vector6d error = ErrorOf(room, edge.T_a_b);
  EXPECT_LT((error.head<3>() - axis * axis.dot(error.head<3>())).norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 0.5 * kDeg);
  const Vector6d off = (edge.T_a_b.Inverse() * *problem.T_a_b_nominal).Log();
  EXPECT_LT(std::abs(axis.dot(off.head<3>())), 0.02);
}

TEST(LidarLidar, CloudsOfTwoPlacesAreRefused) {
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 1, 23);
  for (Eigen::Vector3f& p : problem.captures[0].b_m) p += Eigen::Vector3f(60, 0, 0);
  EXPECT_EQ(CodeOf(problem), "low_overlap");
}

// The few captures that starts are tried on are enough to refuse: with the others or without, the same sentence.
TEST(LidarLidar, TheOtherCapturesOfAHopelessPairAreNotFitted) {
  VirtualRoom corridor;
  corridor.kind = RoomKind::kCorridor;
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 9, 5), few = problem;
  const LidarLidarProblem elsewhere = RecordedIn(corridor, 9, 6);
  few.captures.clear();
  for (std::size_t i = 0; i < 9; ++i) {
    problem.captures[i].b_m = elsewhere.captures[i].b_m;
    if (i % 3 == 0) few.captures.push_back(problem.captures[i]);
  }
  const auto refused = EstimateLidarLidar(problem, nullptr), refused_few = EstimateLidarLidar(few, nullptr);
  ASSERT_FALSE(refused);
  ASSERT_FALSE(refused_few);
  EXPECT_EQ(refused.error().code, "poor_fit");
  EXPECT_EQ(refused.error().what, refused_few.error().what);
}

TEST(LidarLidar, AStartThatIsFarOffIsNotBelieved) {
  const VirtualRoom room;
  LidarLidarProblem problem = RecordedIn(room, 1, 29);
  problem.T_a_b_nominal = room.T_a_b * Se3::Exp((Vector6d() << 1.5, 1.0, 0, 0, 0.9, 0.8).finished());
  const std::string code = CodeOf(problem);
  EXPECT_TRUE(code == "poor_fit" || code == "starts_disagree" || code == "ambiguous_pose" || code == "low_overlap" ||
              code == "not_converged")
      << code;
}

TEST(LidarLidar, WhatIsMissingIsSaid) {
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 1, 31);
  LidarLidarProblem no_start = problem;
  no_start.T_a_b_nominal.reset();
  EXPECT_EQ(CodeOf(no_start), "no_nominal_pose");
  LidarLidarProblem empty = problem;
  empty.captures[0].a_m.clear();
  EXPECT_EQ(CodeOf(empty), "no_common_clouds");
  LidarLidarProblem flat = problem;  // one plane seen by both: two shifts and a turn are anyone's guess
  flat.T_a_b_nominal = Se3();
  for (auto* cloud : {&flat.captures[0].a_m, &flat.captures[0].b_m}) {
    cloud->clear();
    for (int i = 0; i < 160; ++i)
      for (int k = 0; k < 160; ++k)
        cloud->emplace_back(0.05f * i - 4, 0.05f * k - 4, -1.5f + 0.001f * ((i * 7 + k) % 9));
  }
  const Edge edge = EstimateLidarLidarEdge(flat);
  if (edge.state == EdgeState::kGood) {
    EXPECT_LE(edge.uncertainty.rank, 3);
  }
}

TEST(LidarLidar, ARangeBiasGivenIsAContribution) {
  LidarLidarProblem problem = RecordedIn(VirtualRoom(), 1, 37);
  problem.lidar_a.range_bias_sigma_m = 0.02;
  problem.lidar_b.range_bias_sigma_m = 0.02;
  const Edge edge = EstimateLidarLidarEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  ASSERT_EQ(edge.uncertainty.contributions.size(), 5u);
  EXPECT_EQ(edge.uncertainty.contributions[0].name, "range bias of horizontal");
  EXPECT_GT(edge.uncertainty.contributions[0].covariance.trace(), 1e-8);
}

const Contribution& Named(const Edge& edge, const std::string& name) {
  static const Contribution none;
  for (const Contribution& part : edge.uncertainty.contributions)
    if (part.name == name) return part;
  ADD_FAILURE() << name;
  return none;
}

// All groups of beams together are what all ranges share: that is registered anew, these are linear at the pose. Either
// lidar makes the map in one of the two problems, and either is a in one.
TEST(LidarLidar, BeamsTogetherMoveThePoseAsABiasOfAllRanges) {
  for (const bool thinned : {false, true}) {
    LidarLidarProblem problem = RecordedIn(VirtualRoom(), 2, 39);
    for (LidarLidarCapture& capture : problem.captures) {  // the denser lidar makes the map
      std::vector<Eigen::Vector3f>& cloud = thinned ? capture.a_m : capture.b_m;
      std::vector<Eigen::Vector3f> half;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        if ((i / 32) % 2 == 0) half.push_back(cloud[i]);
      cloud = half;
    }
    problem.lidar_a.range_bias_sigma_m = 0.004;
    problem.lidar_b.range_bias_sigma_m = 0.008;
    const std::size_t shifts = 60;
    for (const bool exchanged : {false, true}) {
      const Edge edge = EstimateLidarLidarEdge(exchanged ? Exchanged(problem) : problem);
      ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses.front().what;
      for (const std::string lidar : {"horizontal", "tilted"}) {
        const std::vector<Vector6d> beams = Named(edge, "range biases of single beams of " + lidar).shifts;
        ASSERT_EQ(beams.size(), shifts);
        Vector6d sum = Vector6d::Zero();
        for (const Vector6d& beam : beams) sum += beam;
        const Vector6d all = Named(edge, "range bias of " + lidar).shifts.at(0);
        EXPECT_GT(all.norm(), 1e-4) << lidar;
        EXPECT_LT((sum - all).norm(), 0.25 * all.norm())
            << lidar << (thinned ? " thinned" : "") << (exchanged ? " exchanged\n" : "\n") << sum.transpose() << "\n"
            << all.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace rigcal::calib
