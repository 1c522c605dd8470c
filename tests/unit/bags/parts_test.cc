// metadata.yaml of a bag comes from anybody: what is nested deep in it ends no program.
#include "client/bags/parts.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/unit/temp_folder.h"

namespace rigcal::bags {
namespace {

class BagParts : public testing::Test {
 protected:
  Result<Parts> WithMetadata(const std::string& yaml) const {
    std::ofstream(folder_.path() / "metadata.yaml") << yaml;
    std::ofstream(folder_.path() / "drive_0.mcap") << "x";
    return PartsOf(folder_.path());
  }

  const TempFolder folder_;
};

TEST_F(BagParts, AreWhatMetadataLists) {
  const auto parts = WithMetadata("rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n");
  ASSERT_TRUE(parts);
  EXPECT_THAT(parts->files, testing::ElementsAre(folder_.path() / "drive_0.mcap"));
  EXPECT_TRUE(parts->doubts.empty());
}

TEST_F(BagParts, APartThatMetadataDoesNotListIsTold) {
  std::ofstream(folder_.path() / "drive_1.mcap") << "x";
  std::ofstream(folder_.path() / "drive_0.mcap.zstd") << "the listed one, as it was before it was unpacked";
  const auto parts = WithMetadata("rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n");
  ASSERT_TRUE(parts);
  EXPECT_THAT(parts->files, testing::SizeIs(1));
  ASSERT_THAT(parts->doubts, testing::SizeIs(1));
  EXPECT_THAT(parts->doubts[0].what, testing::HasSubstr("drive_1.mcap is a part"));
}

TEST_F(BagParts, AreTakenAsTheyLieWhereMetadataIsNestedDeep) {
  constexpr std::size_t kDepth = 20'000;
  std::string maps, sequences;
  for (std::size_t i = 0; i < kDepth; ++i) maps += "{a: ", sequences += "- ";
  for (const std::string& yaml :
       {std::string(kDepth, '[') + std::string(kDepth, ']'), maps + "1" + std::string(kDepth, '}'), sequences + "1",
        "rosbag2_bagfile_information: " + std::string(kDepth, '[') + std::string(kDepth, ']')}) {
    const auto parts = WithMetadata(yaml);
    ASSERT_TRUE(parts) << yaml.substr(0, 40);
    EXPECT_THAT(parts->files, testing::SizeIs(1));
    EXPECT_THAT(parts->doubts, testing::SizeIs(1));
  }
}

// Each of ten lines names the line before ten times.
TEST_F(BagParts, AnchorsDoNotMultiply) {
  std::string yaml = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    yaml += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int j = 0; j < 9; ++j) yaml += ", " + before;
    yaml += "]\n";
  }
  const auto parts = WithMetadata(yaml + "rosbag2_bagfile_information:\n  relative_file_paths: *a9\n");
  ASSERT_TRUE(parts);
  EXPECT_THAT(parts->files, testing::SizeIs(1));
}

}  // namespace
}  // namespace rigcal::bags
