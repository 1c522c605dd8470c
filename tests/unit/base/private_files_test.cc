#include "server/base/files/private_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "server/base/files/durable_file.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

mode_t ModeOf(const fs::path& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 0777;
}

TEST(PrivateFiles, AreOfTheirUserAlone) {
  const TempFolder folder;
  const mode_t before = ::umask(022);
  MakePrivateFiles();
  fs::create_directories(folder.path() / "data");
  std::ofstream(folder.path() / "data/file") << "x";
  EXPECT_TRUE(WriteDurably(folder.path() / "data/durable", "x"));
  ::umask(before);
  EXPECT_EQ(ModeOf(folder.path() / "data"), 0700);
  EXPECT_EQ(ModeOf(folder.path() / "data/file"), 0600);
  EXPECT_EQ(ModeOf(folder.path() / "data/durable"), 0600);
}

TEST(PrivateFiles, FoldersOfBeforeAreToldOf) {
  const TempFolder folder;
  for (const auto& [mode, is_open] : {std::pair(0700, false), {0750, false}, {0755, true}, {0701, true}}) {
    ::chmod(folder.path().c_str(), static_cast<mode_t>(mode));
    EXPECT_EQ(IsOpenToOthers(folder.path()), is_open) << mode;
  }
  EXPECT_FALSE(IsOpenToOthers(folder.path() / "none"));
}

}  // namespace
}  // namespace rigcal
