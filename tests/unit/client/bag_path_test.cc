// What `rigcal push` takes for a bag, and where its session folder stands.
#include "client/push/bag_path.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/temp_folder.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

class BagPath : public testing::Test {
 protected:
  fs::path Touch(const std::string& file) const {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << "x";
    return folder_ / file;
  }

 private:
  const TempFolder temporary_;

 protected:
  const fs::path folder_ = temporary_.path();
};

TEST_F(BagPath, IsAFileOrAFolderOfParts) {
  EXPECT_TRUE(IsBagPath(Touch("drive.mcap")));
  EXPECT_TRUE(IsBagPath(Touch("of_any_name"))) << "its first bytes tell";
  EXPECT_FALSE(IsBagPath(Touch("visit/session.yaml"))) << "its folder was meant";
  Touch("split/split_0.db3");
  EXPECT_TRUE(IsBagPath(folder_ / "split"));
  Touch("packed/packed_0.mcap.zstd");
  EXPECT_TRUE(IsBagPath(folder_ / "packed/"));
  Touch("listed/metadata.yaml");
  EXPECT_TRUE(IsBagPath(folder_ / "listed"));
}

TEST_F(BagPath, IsNoSessionFolder) {
  Touch("visit/left/01.png");
  EXPECT_FALSE(IsBagPath(folder_ / "visit")) << "without session.yaml, which is then asked for";
  Touch("visit/session.yaml"), Touch("visit/drive.mcap");
  EXPECT_FALSE(IsBagPath(folder_ / "visit"));
  EXPECT_FALSE(IsBagPath(folder_ / "nowhere"));
}

TEST_F(BagPath, ItsSessionFolderIsBesideIt) {
  EXPECT_EQ(PushFolderOf("/data/drive.mcap", ""), "/data/drive.mcap.rigcal-push");
  EXPECT_EQ(PushFolderOf("/data/split/", ""), "/data/split.rigcal-push");
  EXPECT_EQ(PushFolderOf("/data/x/../split/.", ""), "/data/split.rigcal-push");
  EXPECT_EQ(PushFolderOf("/data/drive.mcap", "/fast"), "/fast/drive.mcap.rigcal-push");
}

}  // namespace
}  // namespace rigcal::client
