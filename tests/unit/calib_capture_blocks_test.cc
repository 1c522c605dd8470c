// What a pair's jackknife leaves out at once.
#include <gtest/gtest.h>

#include "server/calib/core/capture_blocks.h"

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

}  // namespace
}  // namespace rigcal::calib
