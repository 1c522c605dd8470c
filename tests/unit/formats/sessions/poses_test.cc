#include "server/formats/sessions/poses.h"

#include <gmock/gmock.h>

#include "server/base/limits.h"

namespace rigcal::formats {
namespace {

const std::string kTracker = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";
const std::string kStream = "stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n";

TEST(ReadPoses, ATrackerHasARowPerCaptureInAnyOrder) {
  const auto table = ReadPoses(kTracker + "b,5,1,-2.5,3e-3,0,0,0.6,0.8\r\n\n  \na,7,0,0,0,0.9995,0,0,0\n",
                               SensorKind::kTracker, "body/poses.csv");
  ASSERT_TRUE(table) << Sentence(table.error());
  ASSERT_EQ(table->size(), 2u);
  EXPECT_EQ((*table)[0].capture, CaptureId("a"));
  EXPECT_EQ((*table)[0].T_world_body.q.x(), 1.0);  // normalised
  EXPECT_EQ((*table)[1].capture, CaptureId("b"));
  EXPECT_EQ((*table)[1].stamp.ns, 5);
  EXPECT_EQ((*table)[1].T_world_body.p_m, Eigen::Vector3d(1, -2.5, 0.003));
  EXPECT_EQ((*table)[1].T_world_body.q.z(), 0.6);
  EXPECT_EQ((*table)[1].T_world_body.q.w(), 0.8);
}

TEST(ReadPoses, AStreamHasStampsOfItsOwnClock) {
  const auto table = ReadPoses(kStream + "1700000000000000001,1,2,3,0,0,0,1\n1700000000000000002,1,2,3,0,0,0,-1",
                               SensorKind::kPoseStream, "vio/poses.csv");
  ASSERT_TRUE(table) << Sentence(table.error());
  ASSERT_EQ(table->size(), 2u);
  EXPECT_EQ((*table)[1].stamp.ns, 1'700'000'000'000'000'002);
  EXPECT_EQ((*table)[1].T_world_body.q.w(), 1.0);
  EXPECT_TRUE((*table)[0].capture.empty());
}

TEST(ReadPoses, RowsWithoutACaptureAreATrackersPath) {
  const std::string text = kTracker + ",3,0,0,0,0,0,0,1\nb,5,1,0,0,0,0,0,1\n,4,2,0,0,0,0,0,1\na,2,3,0,0,0,0,0,1\n";
  const auto poses = ReadPoses(text, SensorKind::kTracker, "p.csv");
  ASSERT_TRUE(poses) << Sentence(poses.error());
  ASSERT_EQ(poses->size(), 2u);
  EXPECT_EQ((*poses)[0].capture, CaptureId("a"));
  const auto path = ReadTrackerPath(text, "p.csv");
  ASSERT_TRUE(path) << Sentence(path.error());
  ASSERT_EQ(path->size(), 2u);
  EXPECT_TRUE((*path)[0].capture.empty());
  EXPECT_EQ((*path)[0].stamp.ns, 3);
  EXPECT_EQ((*path)[1].T_world_body.p_m.x(), 2.0);
  EXPECT_TRUE(ReadPosesOf({CaptureId("a"), CaptureId("b")}, text, "p.csv"));
  EXPECT_TRUE(ReadTrackerPath(kTracker + "a,2,3,0,0,0,0,0,1\n", "p.csv")->empty());
}

struct BadPoses {
  SensorKind kind;
  std::string text, what;
};
class RefusedPoses : public testing::TestWithParam<BadPoses> {};

TEST_P(RefusedPoses, NamesTheLine) {
  const auto table = ReadPoses(GetParam().text, GetParam().kind, "p.csv");
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().what, testing::StartsWith(GetParam().what));
  EXPECT_FALSE(table.error().cure.empty());
}

constexpr auto kT = SensorKind::kTracker, kS = SensorKind::kPoseStream;
INSTANTIATE_TEST_SUITE_P(
    Cases, RefusedPoses,
    testing::Values(
        BadPoses{kS, "", "p.csv line 1: the header is \"\", not stamp_ns,x_m"},
        BadPoses{kS, kTracker, "p.csv line 1: the header is \"capture,"},
        BadPoses{kT, kStream, "p.csv line 1: the header is \"stamp_ns,"},
        BadPoses{kT, kTracker, "p.csv: it has no poses"},
        BadPoses{kS, kStream + "1,0,0,0,0,0,0\n", "p.csv line 2: it has 7 fields, not the 8 of stamp_ns"},
        BadPoses{kS, kStream + "1,0,0,0,0,0,0,1,\n", "p.csv line 2: it has 9 fields"},
        BadPoses{kS, kStream + "1,0,nan,0,0,0,0,1\n", "p.csv line 2: y_m \"nan\" is not a finite number"},
        BadPoses{kS, kStream + "1,0,0,inf,0,0,0,1\n", "p.csv line 2: z_m \"inf\" is not a finite number"},
        BadPoses{kT, kTracker + "a,1,0,0,0,0,0,0,one\n", "p.csv line 2: qw \"one\" is not a finite number"},
        BadPoses{kT, kTracker + "a,1,0x1,0,0,0,0,0,1\n", "p.csv line 2: x_m \"0x1\" is not a finite number"},
        BadPoses{kS, kStream + "1.5,0,0,0,0,0,0,1\n", "p.csv line 2: stamp_ns \"1.5\" is not a whole number"},
        BadPoses{kS, kStream + "-1,0,0,0,0,0,0,1\n", "p.csv line 2: stamp_ns \"-1\" is not a whole number"},
        BadPoses{kS, kStream + "9223372036854775807,0,0,0,0,0,0,1\n", "p.csv line 2: stamp_ns"},
        BadPoses{kS, kStream + "1,0,0,0,0,0,0,0.9\n", "p.csv line 2: the quaternion has the length 0.900000, not 1"},
        BadPoses{kS, kStream + "1,0,0,0,0,0,0,0\n", "p.csv line 2: the quaternion has the length 0.000000"},
        BadPoses{kS, kStream + "1,2e6,0,0,0,0,0,1\n", "p.csv line 2: "},
        BadPoses{kS, kStream + "2,0,0,0,0,0,0,1\n\n2,0,0,0,0,0,0,1\n",
                 "p.csv line 4: stamp_ns 2 is not after that of the row before, 2"},
        BadPoses{kT, kTracker + "a,2,0,0,0,0,0,0,1\nb,2,0,0,0,0,0,0,1\na,3,0,0,0,0,0,0,1\n",
                 "p.csv line 4: capture a has a row already"},
        BadPoses{kT, kTracker + ",2,0,0,0,0,0,0,1\n,2,0,0,0,0,0,0,1\n",
                 "p.csv line 3: stamp_ns 2 is not after that of the row before, 2"},
        BadPoses{kT, kTracker + ",2,0,0,0,0,0,0,1\n", "p.csv: it has no poses"},
        BadPoses{kT, kTracker + "a b,2,0,0,0,0,0,0,1\n", "p.csv line 2: capture id \"a b\" is not a valid name"}));

TEST(ReadPosesOf, RefusesCapturesThatNoOtherSensorHas) {
  const std::string text = kTracker + "a,2,0,0,0,0,0,0,1\nb,3,0,0,0,0,0,0,1\n";
  EXPECT_TRUE(ReadPosesOf({CaptureId("a"), CaptureId("b"), CaptureId("c")}, text, "p.csv"));
  const auto refused = ReadPosesOf({CaptureId("a")}, text, "p.csv");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "p.csv line 3: no other sensor has a capture b");
}

TEST(ReadPoses, BoundsItsRows) {
  std::string text = kStream;
  for (std::size_t i = 0; i <= limits::kPoseTableRowsMax; ++i) text += std::to_string(i) + ",0,0,0,0,0,0,1\n";
  const auto refused = ReadPoses(text, SensorKind::kPoseStream, "p.csv");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "p.csv line 1000002: it has more than 1000000 rows");
}

}  // namespace
}  // namespace rigcal::formats
