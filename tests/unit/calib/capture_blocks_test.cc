// What a pair's jackknife leaves out at once.
#include "server/calib/core/capture_blocks.h"

#include <gtest/gtest.h>

#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

std::vector<CaptureId> Captures(std::size_t count) {
  std::vector<CaptureId> all;
  for (std::size_t i = 0; i < count; ++i) all.emplace_back(std::to_string(1000 + i));
  return all;
}

TEST(CaptureBlocks, FewCapturesAreABlockEach) {
  const std::vector<CaptureId> all = Captures(40);
  const auto blocks = CaptureBlocks(all, {all[3], all[39]});
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].id, "1003");
  EXPECT_EQ(blocks[1].captures, std::set<CaptureId>({all[39]}));
}

TEST(CaptureBlocks, ManyAreFortyThatFollowOneAnother) {
  const std::vector<CaptureId> all = Captures(1000);
  const auto blocks = CaptureBlocks(all, {all.begin(), all.end()});
  ASSERT_EQ(blocks.size(), 40u);
  std::set<CaptureId> seen;
  for (const CaptureBlock& block : blocks) {
    EXPECT_EQ(block.captures.size(), 25u);
    seen.insert(block.captures.begin(), block.captures.end());
  }
  EXPECT_EQ(seen.size(), 1000u);
  EXPECT_EQ(blocks[0].id, "1000-1024");
}

// Two pairs of a session use different captures; what they leave out together is the same stretch of it.
TEST(CaptureBlocks, GroupsDoNotDependOnWhatIsUsed) {
  const std::vector<CaptureId> all = Captures(90);
  const auto some = CaptureBlocks(all, {all[10], all[50]}), every = CaptureBlocks(all, {all.begin(), all.end()});
  ASSERT_EQ(some.size(), 2u);
  for (const CaptureBlock& block : some)
    for (const CaptureBlock& whole : every)
      EXPECT_EQ(whole.id == block.id, whole.captures.contains(*block.captures.begin()));
  EXPECT_EQ(IdsOf(every).size(), 40u);
}

TEST(CaptureBlocks, OfTheSessionWhereItIsNotTold) {
  const std::vector<CaptureId> all = Captures(90);
  EXPECT_EQ(CaptureBlocks({}, {all.begin(), all.end()}).size(), 40u);
}

TEST(CaptureBlocks, FollowOneAnotherByNumber) {
  std::vector<CaptureId> all;
  for (int i = 1; i <= 80; ++i) all.emplace_back(std::to_string(i));
  const auto blocks = CaptureBlocks(all, {all.begin(), all.end()});
  EXPECT_EQ(blocks[0].id, "1-2");
  EXPECT_EQ(blocks[39].id, "79-80");
}

// The wire and documents hold 64 characters.
TEST(CaptureBlocks, IdsAreShort) {
  std::vector<CaptureId> all;
  for (int i = 0; i < 82; ++i) all.emplace_back("image_2026-01-31_12-00-00_" + std::to_string(100000 + i));
  const auto blocks = CaptureBlocks(all, {all.begin(), all.end()});
  ASSERT_EQ(blocks.size(), 40u);
  std::set<std::string> ids;
  for (const CaptureBlock& block : blocks) ids.insert(block.id);
  EXPECT_EQ(ids.size(), 40u);
  for (const std::string& id : ids) EXPECT_LE(id.size(), 64u);
}

TEST(CaptureBlocks, CountsThoseThatCarryAPair) {
  const std::vector<CaptureId> all = Captures(400);
  const auto blocks = CaptureBlocks(all, {all.begin(), all.end()});
  EXPECT_EQ(CountWith(blocks, {all.begin() + 100, all.begin() + 120}), 2u);
  EXPECT_EQ(CountWith(blocks, {}), 0u);
}

// Twelve captures of a session of 800, all in one of its stretches: nothing is left of the pair without it.
TEST(CaptureBlocks, APairOfOneStretchIsTheModels) {
  VirtualPair pair;
  StereoProblem problem = Photographed(pair, TiltedBoards(12), 0.1, 3);
  problem.camera_a.intrinsics = pair.a;
  problem.camera_b.intrinsics = pair.b;
  for (int i = 0; i < 800; ++i) problem.session_captures.emplace_back(std::to_string(1000 + i).substr(1));
  const Edge edge = EstimateEdge(problem);
  ASSERT_EQ(edge.state, EdgeState::kGood);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kModel);
  EXPECT_TRUE(edge.uncertainty.blocks.empty());
  EXPECT_EQ(edge.uncertainty.dof, 1);
}

// Two sets of captures, the same session: what is left out of both has one name.
TEST(CaptureBlocks, PairsOfASessionShareTheirBlocks) {
  VirtualPair pair;
  StereoProblem first = Photographed(pair, TiltedBoards(12), 0.1, 3);
  for (int i = 0; i < 60; ++i) first.session_captures.emplace_back(std::to_string(1000 + i).substr(1));
  StereoProblem second = first;
  second.captures.erase(second.captures.begin(), second.captures.begin() + 1);
  std::set<std::string> ids;
  for (const StereoProblem* problem : {&first, &second})
    for (const BlockVector& block : EstimateEdge(*problem).uncertainty.blocks) ids.insert(block.block_id);
  EXPECT_EQ(ids, std::set<std::string>({"000", "001-002", "003", "004-005", "006", "007-008", "009", "010-011"}));
}

}  // namespace
}  // namespace rigcal::calib
