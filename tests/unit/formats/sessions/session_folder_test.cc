#include "server/formats/sessions/session_folder.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "server/base/digests/sha256.h"
#include "server/formats/sessions/session_contents.h"
#include "tests/unit/formats/samples.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

const std::string kPng = std::string("\x89PNG\r\n\x1a\n", 8) + "left";
const std::string kJpeg = "\xff\xd8\xff\xe0right";

class SessionFolder : public testing::Test {
 protected:
  void SetUp() override {
    Write("session.yaml",
          "format: 1\nrobot: mapper-01\ncaptured_at: 2026-01-31T12:00:00Z\ntargets:\n  board: {type: checkerboard, "
          "inner_corners: [9, 6], square_size_m: 0.025}\nsensors:\n  left: {type: camera}\n  right: {type: camera}\n");
    Write("left/01.png", kPng);
    Write("right/01.jpg", kJpeg);
    Write("right/02.jpeg", kJpeg + "2");
  }

  void Write(const std::string& path, const std::string& bytes) {
    fs::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path, std::ios::binary) << bytes;
  }
  Result<Manifest> Read() { return ReadSessionFolder(folder_, {}); }
  void ExpectRefused(const std::string& what) {
    const auto manifest = Read();
    ASSERT_FALSE(manifest);
    EXPECT_THAT(manifest.error().what, testing::HasSubstr(what));
    EXPECT_FALSE(manifest.error().cure.empty());
  }

  TempFolder place_;
  fs::path root_ = place_.path(), folder_ = root_ / "session";
};

TEST_F(SessionFolder, BecomesAManifestSortedByPath) {
  const auto manifest = Read();
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  ASSERT_EQ(manifest->payloads.size(), 3u);
  EXPECT_EQ(manifest->payloads[0].path, "left/01.png");
  EXPECT_EQ(manifest->payloads[0].digest, Sha256Of(kPng));
  EXPECT_EQ(manifest->payloads[0].size_bytes, 12);
  EXPECT_EQ(manifest->payloads[1].sensor, SensorId("right"));
  EXPECT_EQ(manifest->payloads[1].capture, CaptureId("01"));
  EXPECT_EQ(manifest->payloads[2].path, "right/02.jpeg");
}

TEST_F(SessionFolder, IsTheSameSessionWhereverItIs) {
  const auto before = Read();
  const fs::path moved = root_ / "moved";
  fs::rename(folder_, moved);
  folder_ = moved;
  const auto after = Read();
  ASSERT_TRUE(before && after);
  EXPECT_EQ(WriteManifest(*before), WriteManifest(*after));
  EXPECT_TRUE(ReadManifest(WriteManifest(*after)));
}

TEST_F(SessionFolder, ReportsProgressUpToTheEnd) {
  std::int64_t last = 0, all = 0;
  int calls = 0;
  const auto manifest = ReadSessionFolder(folder_, [&](std::int64_t hashed, std::int64_t in_all) {
    EXPECT_GT(hashed, last);
    last = hashed;
    all = in_all;
    ++calls;
  });
  ASSERT_TRUE(manifest);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(last, 12 + 9 + 10);
  EXPECT_EQ(all, last);
}

TEST_F(SessionFolder, ABinThatCouldBeAnythingAsksForItsFields) {
  std::string yaml = samples::FileText((folder_ / "session.yaml").string());
  yaml.insert(yaml.find("sensors:\n") + 9, "  top: {type: lidar}\n");
  Write("session.yaml", yaml);
  std::string points;
  for (int i = 0; i < 2000; ++i)
    for (const float value : {5.0f + 0.01f * static_cast<float>(i % 100), 0.01f * static_cast<float>(i), 1.0f, 0.3f,
                              static_cast<float>(i % 32)})
      points.append(reinterpret_cast<const char*>(&value), sizeof value);
  Write("top/01.bin", points);
  ExpectRefused("file \"top/01.bin\": it is not certain to hold KITTI's 4 floats a point");
  EXPECT_THAT(Read().error().cure, testing::HasSubstr("under sensor 'top' what a point holds, such as fields: [x, y"));
  yaml.replace(yaml.find("{type: lidar}"), 13, "{type: lidar, fields: [x, y, z, intensity, ring]}");
  Write("session.yaml", yaml);
  const auto manifest = Read();
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  Write("top/01.bin", points.substr(4));
  ExpectRefused("file \"top/01.bin\": has 39996 bytes, which is no multiple of 20");
}

TEST_F(SessionFolder, IgnoresDotFiles) {
  Write(".DS_Store", "x");
  Write("left/.hidden.txt", "x");
  Write(".git/config", "x");
  EXPECT_TRUE(Read());
}

TEST_F(SessionFolder, FollowsLinksThatStayInside) {
  fs::create_symlink("01.jpg", folder_ / "right/03.jpg");
  const auto manifest = Read();
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  EXPECT_EQ(manifest->payloads[3].digest, Sha256Of(kJpeg));
}

TEST_F(SessionFolder, RefusesLinksThatLeaveOrDangle) {
  std::ofstream(root_ / "secret.png", std::ios::binary) << kPng;
  fs::create_symlink("../../secret.png", folder_ / "left/02.png");
  ExpectRefused("file \"left/02.png\": the symbolic link leads out of the session");
  fs::remove(folder_ / "left/02.png");
  fs::create_symlink("nothing.png", folder_ / "left/02.png");
  ExpectRefused("file \"left/02.png\": the symbolic link leads nowhere");
  fs::remove(folder_ / "left/02.png");
  fs::rename(folder_ / "left", root_ / "session-left");  // a sibling whose path begins like the session's
  fs::create_directory_symlink("../session-left", folder_ / "left");
  ExpectRefused("file \"left\": the symbolic link leads out of the session");
}

TEST_F(SessionFolder, RefusesAFolderOfNoSensor) {
  Write("rigth/01.png", kPng);
  ExpectRefused("folder \"rigth\": session.yaml has no sensor of this name; did you mean \"right\"?");
}

TEST_F(SessionFolder, RefusesFilesThatDoNotBelong) {
  Write("README.txt", "x");
  ExpectRefused("file \"README.txt\": it does not belong to a session");
  fs::remove(folder_ / "README.txt");
  Write("left/notes.txt", "x");
  ExpectRefused("file \"left/notes.txt\": its name does not end in .png, .jpg, .jpeg, .pcd, .ply, .bin or .csv");
  fs::remove(folder_ / "left/notes.txt");
  Write("left/02.PNG", kPng);
  ExpectRefused("file \"left/02.PNG\": its name does not end in .png, .jpg, .jpeg, .pcd, .ply, .bin or .csv");
  fs::remove(folder_ / "left/02.PNG");
  Write("left/deep/01.png", kPng);
  ExpectRefused("file \"left/deep\": it is not a file");
}

TEST_F(SessionFolder, RefusesBadNames) {
  Write("left/a b.png", kPng);
  ExpectRefused("file \"left/a b.png\": capture id \"a b\" is not a valid name");
}

TEST_F(SessionFolder, RefusesPipes) {
  ASSERT_EQ(mkfifo((folder_ / "left/02.png").c_str(), 0600), 0);
  ExpectRefused("file \"left/02.png\": it is not a file");
}

TEST_F(SessionFolder, RefusesEmptyAndRenamedPictures) {
  Write("left/02.png", "");
  ExpectRefused("file \"left/02.png\": it is empty");
  Write("left/02.png", kJpeg);
  ExpectRefused("file \"left/02.png\": it is a JPEG picture, not a PNG picture");
  Write("left/02.png", "\x89P");
  ExpectRefused("file \"left/02.png\": it is not a PNG picture");
  fs::remove(folder_ / "left/02.png");
  Write("left/02.jpg", kPng);
  ExpectRefused("file \"left/02.jpg\": it is a PNG picture, not a JPEG picture");
}

TEST_F(SessionFolder, RefusesTwoFilesOfOneCapture) {
  Write("left/01.jpg", kJpeg);
  ExpectRefused("sensor 'left' has another file of capture '01'");
}

TEST_F(SessionFolder, RefusesAFolderWithoutCaptures) {
  for (const char* sensor : {"left", "right"})
    for (const auto& entry : fs::directory_iterator(folder_ / sensor)) fs::remove(entry.path());
  ExpectRefused("it has no captures");
}

TEST_F(SessionFolder, ReadsTablesOfPosesBeforeTheyAreSent) {
  std::ifstream before(folder_ / "session.yaml");
  const std::string yaml((std::istreambuf_iterator<char>(before)), {});
  Write("session.yaml", yaml + "  body: {type: tracker}\n  vio: {type: pose_stream}\n");
  const std::string header = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";
  Write("body/poses.csv", header + "01,0,0,0,0,0,0,0,1\n02,1,0,0,0,0,0,0,1\n");
  Write("vio/poses.csv", header.substr(8) + "0,0,0,0,0,0,0,1\n");
  const auto manifest = Read();
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  EXPECT_EQ(manifest->payloads[0].path, "body/poses.csv");
  EXPECT_EQ(manifest->payloads[0].capture, CaptureId("poses"));
  Write("body/poses.csv", header + "01,0,0,0,0,0,0,0,1\n03,1,0,0,0,0,0,0,1\n");
  ExpectRefused("body/poses.csv line 3: no other sensor has a capture 03");
  Write("body/poses.csv", header + "01,0,0,0,0,0,0,0,1\n");
  Write("vio/poses.csv", header);
  ExpectRefused("vio/poses.csv line 1: the header is \"capture,stamp_ns");
  fs::rename(folder_ / "vio/poses.csv", folder_ / "vio/pose.csv");
  ExpectRefused("file \"vio/pose.csv\": the path is not <sensor>/poses.csv");
}

TEST_F(SessionFolder, GivesTheTablesOfTrackersAlone) {
  std::ifstream before(folder_ / "session.yaml");
  const std::string yaml((std::istreambuf_iterator<char>(before)), {});
  Write("session.yaml", yaml + "  body: {type: tracker}\n  vio: {type: pose_stream}\n");
  const std::string header = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";
  Write("body/poses.csv", header + "02,1,210,0,0,0,0,0,1\n01,0,0,0,0,0,0,0,1\n");
  Write("vio/poses.csv", header.substr(8) + "0,0,0,0,0,0,0,1\n");
  const auto manifest = Read();
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  const auto tables = ReadTrackers(folder_, *manifest);
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables.at(SensorId("body")).back().T_world_body.p_m.x(), 210.0);
  fs::remove(folder_ / "body/poses.csv");
  EXPECT_TRUE(ReadTrackers(folder_, *manifest).empty());
}

TEST_F(SessionFolder, ASurveyTellsEachRefusalAndReadsTheRest) {
  Write("left/02.png", "");
  Write("left/03.png", kJpeg);
  Write("left/04.pcd", "# .PCD");
  Write("notes.txt", "x");
  Write("rigth/01.png", kPng);
  Write("right/01.png", kPng);
  const auto survey = SurveySessionFolder(folder_, {});
  ASSERT_TRUE(survey) << Sentence(survey.error());
  std::vector<std::string> told, kept;
  for (const Error& refusal : survey->refusals) told.push_back(refusal.what);
  for (const Payload& payload : survey->manifest.payloads) kept.push_back(payload.path);
  EXPECT_THAT(kept, testing::ElementsAre("left/01.png", "right/01.jpg", "right/02.jpeg"));
  using testing::HasSubstr;
  EXPECT_THAT(
      told, testing::ElementsAre(HasSubstr("left/02.png\": it is empty"), HasSubstr("left/03.png\": it is a JPEG"),
                                 HasSubstr("notes.txt"), HasSubstr("rigth"), HasSubstr("another file of capture '01'"),
                                 HasSubstr("left/04.pcd")));
  EXPECT_EQ(Read().error().what, told.front());
}

TEST_F(SessionFolder, ASurveyOfAGoodFolderIsItsManifest) {
  const auto survey = SurveySessionFolder(folder_, {});
  ASSERT_TRUE(survey) << Sentence(survey.error());
  EXPECT_TRUE(survey->refusals.empty());
  EXPECT_EQ(WriteManifest(survey->manifest), WriteManifest(*Read()));
}

TEST_F(SessionFolder, ASurveyEndsWhereThereIsNoSession) {
  Write("session.yaml", "format: 1\nrobot: 'a b'\n");
  EXPECT_FALSE(SurveySessionFolder(folder_, {}));
  fs::remove_all(folder_ / "left");
  fs::remove_all(folder_ / "right");
  fs::remove(folder_ / "session.yaml");
  EXPECT_FALSE(SurveySessionFolder(folder_, {}));
}

TEST_F(SessionFolder, ASurveyKeepsTheTableOfATrackerWhoseCapturesAreRefused) {
  const std::string yaml = samples::FileText((folder_ / "session.yaml").string());
  Write("session.yaml", yaml + "  body: {type: tracker}\n");
  Write("body/poses.csv", "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n01,0,0,0,0,0,0,0,1\n07,1,0,0,0,0,0,0,1\n");
  Write("left/07.png", "");
  const auto survey = SurveySessionFolder(folder_, {});
  ASSERT_TRUE(survey);
  EXPECT_EQ(survey->refusals.size(), 1u);
  EXPECT_EQ(survey->manifest.payloads.front().path, "body/poses.csv");
}

TEST_F(SessionFolder, RefusesWhatIsNoSession) {
  fs::remove(folder_ / "session.yaml");
  ExpectRefused("it has no session.yaml");
  fs::remove_all(folder_);
  ExpectRefused("there is no such folder");
}

TEST_F(SessionFolder, NamesTheLineOfSessionYaml) {
  Write("session.yaml", "format: 1\nrobot: 'a b'\n");
  ExpectRefused("session.yaml line 2: robot: robot id \"a b\" is not a valid name");
}

}  // namespace
}  // namespace rigcal::formats
