// A session with very many captures: what each pair uses of it.
#include <gtest/gtest.h>

#include "server/calib/core/pair_captures.h"
#include "server/calib/stereo/stereo.h"
#include "tests/unit/calib_virtual_pair.h"

namespace rigcal::calib {
namespace {

std::vector<CaptureId> Captures(int count) {
  std::vector<CaptureId> captures;
  for (int i = 0; i < count; ++i) captures.emplace_back(std::to_string(10000 + i).substr(1));
  return captures;
}

std::set<CaptureId> Every(const std::vector<CaptureId>& captures, std::size_t step) {
  std::set<CaptureId> some;
  for (std::size_t i = 0; i < captures.size(); i += step) some.insert(captures[i]);
  return some;
}

TEST(PairCaptures, OfAFewAllAreUsed) {
  const auto all = Captures(kPairCapturesMax);
  const PairCaptures chosen = ChooseCaptures(all, Every(all, 1));
  EXPECT_EQ(chosen.used, Every(all, 1));
  EXPECT_TRUE(chosen.left_out.empty());
  EXPECT_TRUE(ChooseCaptures({}, {}).left_out.empty());
}

// Each stretch of the session gives as many as any other: 120 of 1,000 are 3 of every 25. Captures that alternate between two
// boards give as many of each.
TEST(PairCaptures, OfManyThoseThatAreEvenlySpread) {
  const auto all = Captures(1000);
  const PairCaptures chosen = ChooseCaptures(all, Every(all, 1));
  EXPECT_EQ(chosen.used.size(), kPairCapturesMax);
  EXPECT_EQ(chosen.left_out.size(), 1000 - kPairCapturesMax);
  for (std::size_t first = 0; first < all.size(); first += 25) {
    const auto used = std::count_if(all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(first) + 25,
                                    [&](const CaptureId& capture) { return chosen.used.contains(capture); });
    EXPECT_EQ(used, 3) << first;
  }
  const auto alternating = Captures(2 * static_cast<int>(kPairCapturesMax));
  std::size_t even = 0;
  for (const CaptureId& capture : ChooseCaptures(alternating, {}).used) even += (capture.str().back() - '0') % 2 == 0 ? 1 : 0;
  EXPECT_GT(even, kPairCapturesMax / 3);
  EXPECT_LT(even, 2 * kPairCapturesMax / 3);
}

// All pairs use the same captures, so that a camera is estimated once; one that is seldom seen by both adds its own.
TEST(PairCaptures, AreThoseOfAllPairsAndMoreWhereBothSeldomSee) {
  const auto all = Captures(1000);
  const std::set<CaptureId> whole = ChooseCaptures(all, Every(all, 1)).used;
  std::set<CaptureId> mostly = Every(all, 1);
  for (const CaptureId& capture : Every(all, 5)) mostly.erase(capture);
  EXPECT_EQ(ChooseCaptures(all, mostly).used, whole);
  const std::set<CaptureId> seldom = Every(all, 50);
  const std::set<CaptureId> used = ChooseCaptures(all, seldom).used;
  for (const CaptureId& capture : seldom) EXPECT_TRUE(used.contains(capture)) << capture.str();
  for (const CaptureId& capture : whole) EXPECT_TRUE(used.contains(capture)) << capture.str();
  const std::set<CaptureId> often = Every(all, 12);
  std::size_t both = 0;
  for (const CaptureId& capture : ChooseCaptures(all, often).used) both += often.contains(capture) ? 1 : 0;
  EXPECT_EQ(both, kSeenByBothMin);
}

TEST(PairCaptures, ThoseLeftOutAreToldOnTheEdge) {
  VirtualPair pair;
  const int count = static_cast<int>(kPairCapturesMax) + 30;
  StereoProblem problem = Photographed(pair, TiltedBoards(count), 0.1, 3);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  for (const StereoCapture& capture : problem.captures) problem.session_captures.push_back(capture.capture);
  const Edge edge = EstimateEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  ASSERT_EQ(edge.captures.size(), static_cast<std::size_t>(count));
  EXPECT_TRUE(std::is_sorted(edge.captures.begin(), edge.captures.end(),
                             [](const auto& a, const auto& b) { return a.capture < b.capture; }));
  const auto left_out = std::count_if(edge.captures.begin(), edge.captures.end(), [](const CaptureResidual& one) {
    return !one.used && one.note.find("left to the joint refinement") == 0;
  });
  EXPECT_EQ(left_out, 30);
  EXPECT_EQ(edge.figures.at("captures_total"), count);
  EXPECT_LE(edge.figures.at("captures_used"), static_cast<double>(kPairCapturesMax));
  EXPECT_LT((edge.T_a_b.p_m - pair.T_a_b.p_m).norm(), 1e-3);
}

// What fails with the captures chosen is tried with all: here the boards of those are all parallel to the picture.
TEST(PairCaptures, APairThatNeedsMoreUsesAll) {
  VirtualPair pair;
  const int count = static_cast<int>(kPairCapturesMax) + 30;
  StereoProblem problem = Photographed(pair, TiltedBoards(count), 0.1, 3);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  for (const StereoCapture& capture : problem.captures) problem.session_captures.push_back(capture.capture);
  std::set<CaptureId> both;
  for (const StereoCapture& capture : problem.captures) both.insert(capture.capture);
  const PairCaptures chosen = ChooseCaptures(problem.session_captures, both);
  for (StereoCapture& capture : problem.captures)
    if (chosen.used.contains(capture.capture)) capture.b->corners_px.front().x() += 300;
  EXPECT_NE(EstimateEdge(problem).captures.front().note.substr(0, 26), std::string(kLeftToRefinement).substr(0, 26));
}

}  // namespace
}  // namespace rigcal::calib
