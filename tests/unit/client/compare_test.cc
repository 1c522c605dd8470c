// Poses of a revision against a file or another revision.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "client/text/pose_comparison.h"

namespace rigcal::client {
namespace {

using testing::HasSubstr;

Se3 At(double x, double y, double z, double yaw = 0) {
  Se3 T;
  T.p_m = {x, y, z};
  T.q = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  return T;
}

// Gone with the object.
class TextFile {
 public:
  explicit TextFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("compare-" + std::to_string(::getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml")) {
    std::ofstream(path_) << text;
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  ~TextFile() { std::filesystem::remove(path_); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(Compare, TheErrorIsAlongTheSensorsOwnAxes) {
  // b looks along its x axis at the reference's y axis; it was moved by 1 mm along its own x.
  const KnownPoses poses{{"a", {At(0, 0, 0), {}}}, {"b", {At(1, 2.001, 3, M_PI / 2), Vector6d::Constant(0.0005)}}};
  const KnownPoses truth{{"a", {At(0, 0, 0), {}}}, {"b", {At(1, 2, 3, M_PI / 2), {}}}};
  const auto differences = ComparePoses(poses, truth, "a");
  ASSERT_TRUE(differences);
  ASSERT_EQ(differences->size(), 1U);
  EXPECT_NEAR(differences->at(0).e[0], 0.001, 1e-12);
  EXPECT_NEAR(differences->at(0).e.tail<5>().norm(), 0, 1e-12);
  EXPECT_NEAR(*differences->at(0).WorstSigmas(), 2.0, 1e-9);
}

// As on the page that compares two revisions.
TEST(Compare, TheLargerSigmaOfBothCounts) {
  const KnownPoses now{{"a", {At(0, 0, 0), {}}}, {"b", {At(1.006, 0, 0), Vector6d::Constant(0.001)}}};
  KnownPoses before{{"a", {At(0, 0, 0), {}}}, {"b", {At(1, 0, 0), Vector6d::Constant(0.003)}}};
  EXPECT_NEAR(*ComparePoses(now, before, "a")->at(0).WorstSigmas(), 2.0, 1e-9);
  before["b"].sigma.reset();
  EXPECT_NEAR(*ComparePoses(now, before, "a")->at(0).WorstSigmas(), 6.0, 1e-9);
}

TEST(Compare, ARigidMotionOfTheOtherRigDoesNotShow) {
  const Se3 moved = At(5, -3, 1, 0.7);
  const KnownPoses poses{{"a", {At(0, 0, 0), {}}}, {"b", {At(1, 2, 3, 0.2), {}}}, {"c", {At(-1, 0, 0), {}}}};
  KnownPoses others = poses;
  for (auto& [name, pose] : others) pose.T_ref_sensor = moved * pose.T_ref_sensor;
  const auto differences = ComparePoses(poses, others, "a");
  ASSERT_TRUE(differences);
  EXPECT_EQ(differences->size(), 2U);
  for (const PoseDifference& difference : *differences) EXPECT_NEAR(difference.e.norm(), 0, 1e-12);
}

TEST(Compare, WithoutTheReferenceOrACommonSensorItSaysSo) {
  const KnownPoses poses{{"a", {}}, {"b", {}}}, other{{"b", {}}}, alone{{"a", {}}, {"c", {}}};
  EXPECT_THAT(ComparePoses(poses, other, "a").error().what, HasSubstr("reference sensor 'a'"));
  EXPECT_THAT(ComparePoses(poses, alone, "a").error().what, HasSubstr("no sensor but the reference"));
}

TEST(Compare, AFileMayBeATruthOrASession) {
  const auto poses =
      PosesOfFile(TextFile("format: 1\n"
                           "sensors:\n"
                           "  left: {type: camera, T_ref_nominal: {p_m: [0, 0, 0], q_xyzw: [0, 0, 0, 1]}}\n"
                           "  top: {T_ref_sensor: {p_m: [1, 2, 3], q_xyzw: [0, 0, 0.6, 0.8]}}\n"
                           "  none: {type: lidar}\n")
                      .path());
  ASSERT_TRUE(poses) << poses.error().what;
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ(poses->at("top").T_ref_sensor.p_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(poses->at("top").T_ref_sensor.q.z(), 0.6, 1e-12);
}

TEST(Compare, AWrongFileIsASentenceThatNamesThePlace) {
  EXPECT_THAT(PosesOfFile("/does/not/exist.yaml").error().what, HasSubstr("/does/not/exist.yaml cannot be read"));
  EXPECT_THAT(PosesOfFile(TextFile("sensors:\n  top: {T_ref_sensor: {p_m: [1, 2, 3], q_xyzw: [0, 0, 0, 2]}}\n").path())
                  .error()
                  .what,
              testing::AllOf(HasSubstr("line 2"), HasSubstr("sensor 'top'"), HasSubstr("unit length")));
}

TEST(Compare, ARevisionGivesPosesAndSigmas) {
  const auto revision = Document::Parse(
      R"({"sensors":[{"id":"a","T_ref_sensor":{"p_m":[0,0,0],"q_xyzw":[0,0,0,1]},"sigma_m":[0,0,0],"sigma_rad":[0,0,0]},)"
      R"({"id":"b","T_ref_sensor":{"p_m":[1,2,3],"q_xyzw":[0,0,0,1]},"sigma_m":[0.1,0.2,0.3],"sigma_rad":[1,2,3]},)"
      R"({"id":"lost","T_ref_sensor":null,"sigma_m":null,"sigma_rad":null}]})",
      "test");
  ASSERT_TRUE(revision);
  const KnownPoses poses = PosesOfRevision(*revision);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ((*poses.at("b").sigma)[2], 0.3);
  EXPECT_EQ((*poses.at("b").sigma)[5], 3);
}

}  // namespace
}  // namespace rigcal::client
