// A session with very many captures: what each pair uses of it.
#include <gtest/gtest.h>

#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/stereo/stereo.h"
#include "tests/unit/calib/virtual_pair.h"

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

// Each stretch of the session gives as many as any other: 120 of 1,000 are 3 of every 25. Captures that alternate
// between two boards give as many of each.
TEST(PairCaptures, OfManyThoseThatAreEvenlySpread) {
  const auto all = Captures(1000);
  const PairCaptures chosen = ChooseCaptures(all, Every(all, 1));
  EXPECT_EQ(chosen.used.size(), kPairCapturesMax);
  EXPECT_EQ(chosen.left_out.size(), 1000 - kPairCapturesMax);
  for (std::size_t first = 0; first < all.size(); first += 25) {
    const auto used = std::count_if(all.begin() + static_cast<std::ptrdiff_t>(first),
                                    all.begin() + static_cast<std::ptrdiff_t>(first) + 25,
                                    [&](const CaptureId& capture) { return chosen.used.contains(capture); });
    EXPECT_EQ(used, 3) << first;
  }
  const auto alternating = Captures(2 * static_cast<int>(kPairCapturesMax));
  std::size_t even = 0;
  for (const CaptureId& capture : ChooseCaptures(alternating, {}).used)
    even += (capture.str().back() - '0') % 2 == 0 ? 1 : 0;
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

struct SomeProblem {
  std::vector<StereoCapture> captures;
  std::vector<CaptureId> session_captures;
};

// `tells`: what is told of so many captures.
template <typename Tells>
Edge EdgeOf(const SomeProblem& problem, const Tells& tells) {
  const std::set<CaptureId> captures = CapturesOf(problem);
  const auto estimate = [&](const SomeProblem& one) {
    Edge edge = tells(one.captures.size());
    for (const StereoCapture& capture : one.captures) edge.captures.push_back({capture.capture, 0.1, true, ""});
    return edge;
  };
  return EdgeOfChosen(problem, captures, captures, DropCaptures<SomeProblem>, estimate,
                      [](const Error&) { return Edge{}; });
}

// A pair that fails with the captures chosen, or leaves a direction open, is tried with all, and tells of none left
// out.
TEST(PairCaptures, WhatTheChosenCannotTellIsAskedOfAll) {
  SomeProblem problem;
  problem.session_captures = Captures(200);
  for (const CaptureId& capture : problem.session_captures) problem.captures.push_back({capture, {}, {}});
  const auto good = [](int rank) {
    Edge edge;
    edge.state = EdgeState::kGood;
    edge.uncertainty.rank = rank;
    return edge;
  };
  const auto used = [](const Edge& edge) {
    return std::count_if(edge.captures.begin(), edge.captures.end(),
                         [](const CaptureResidual& one) { return one.used; });
  };
  const Edge enough = EdgeOf(problem, [&](std::size_t) { return good(6); });
  EXPECT_EQ(used(enough), static_cast<std::ptrdiff_t>(kPairCapturesMax));
  EXPECT_EQ(enough.captures.size(), 200u);
  const Edge failed = EdgeOf(problem, [&](std::size_t count) { return count < 200 ? Edge{} : good(6); });
  EXPECT_EQ(failed.state, EdgeState::kGood);
  EXPECT_EQ(used(failed), 200);
  const Edge open = EdgeOf(problem, [&](std::size_t count) { return good(count < 200 ? 5 : 6); });
  EXPECT_EQ(open.uncertainty.rank, 6);
  EXPECT_EQ(used(open), 200);
}

// A capture that is none of the pair's, as it has no files in it, is not told as left out.
TEST(PairCaptures, OnlyThePairsOwnAreToldAsLeftOut) {
  SomeProblem problem;
  problem.session_captures = Captures(400);
  for (std::size_t i = 0; i < 400; i += 2) problem.captures.push_back({problem.session_captures[i], {}, {}});
  const Edge edge = EdgeOf(problem, [](std::size_t) {
    Edge good;
    good.state = EdgeState::kGood;
    good.uncertainty.rank = 6;
    return good;
  });
  EXPECT_EQ(edge.captures.size(), 200u);
  EXPECT_EQ(edge.figures.at("captures_total"), 200);
}

}  // namespace
}  // namespace rigcal::calib
