// What revisions keep of causes, and by which keys lists of robots count them.
#include "server/fleet/causes/told_causes.h"

#include <gmock/gmock.h>

#include "tests/unit/fleet/causes/visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> KeysOf(const Visit& visit, const GraphSolution& solution = {}) {
  return CauseKeysOf(visit.Causes(solution), visit.edges, visit.Times());
}

// `ratio`: how much larger the squares are than given.
Visit OtherBoard(double ratio) {
  Visit visit(StereoBoard());
  visit.AddSensor("top", SensorKind::kLidar);
  for (const char* camera : {"front", "left"}) {
    visit.AddSensor(camera, SensorKind::kCamera);
    visit.AddFailed(camera, "top", "lidar_camera", "board_size_suspected",
                    {{"board_scale_ratio", ratio}, {"board_scale_sigma_ratio", 0.002}, {"board_square_m", 0.03}});
  }
  return visit;
}

TEST(ToldCauses, AreSentencesWithTheCommandBesideThem) {
  const Visit visit = OtherBoard(0.03);
  const std::vector<Cause> causes = ToldCauses(visit.Causes());
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, "board_size");
  EXPECT_EQ(causes[0].key, "board_size calib larger");
  EXPECT_THAT(causes[0].boards, ElementsAre(TargetId("calib")));
  EXPECT_THAT(causes[0].edges, ElementsAre(visit.edges[0].id, visit.edges[1].id));
  EXPECT_EQ(causes[0].why,
            "The squares of board calib are probably 30.90 mm, not 30.00 mm (2 pairs see it 3 % larger).");
  EXPECT_EQ(causes[0].what_to_do,
            "Measure one with a caliper and correct session.yaml, probably to `square_size_m: 0.03090`.");
  EXPECT_EQ(causes[0].command, "rigcal push FOLDER");
}

TEST(ToldCauses, ASensorsNameStaysAsItIsWritten) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  const std::vector<Cause> causes = ToldCauses(visit.Causes());
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].why, "rear sees board calib in none of 12 pictures.");
  EXPECT_EQ(causes[0].key, "board_unseen rear");
}

TEST(CauseKeys, AreTheSameOnRobotsThatDifferInNumbersOnly) {
  EXPECT_THAT(KeysOf(OtherBoard(0.03)), ElementsAre("board_size calib larger"));
  EXPECT_THAT(KeysOf(OtherBoard(0.04)), ElementsAre("board_size calib larger"));
  EXPECT_THAT(KeysOf(OtherBoard(-0.03)), ElementsAre("board_size calib smaller"));
}

TEST(CauseKeys, OfWhatIsDoneAboutTheSessionNameNoSensor) {
  Visit visit(StereoBoard());
  visit.AddStereos({{"left", "BB"}, {"rear", "BB"}, {"right", "BB"}});
  EXPECT_THAT(KeysOf(visit), ElementsAre("short_session"));
}

TEST(CauseKeys, OfManySensorsNameFour) {
  Visit visit(StereoBoard());
  visit.AddGood("left", "right");
  EXPECT_THAT(KeysOf(visit, SolutionOf({"left", "right"}, {"a", "b", "c", "d", "e", "f"})),
              ElementsAre("not_measured a b c d +2"));
}

TEST(CauseKeys, OfPairsThatNoCauseExplainsNameBothWhateverTheirOrder) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  visit.AddFailed("top", "front", "lidar_camera", "no_agreement");
  EXPECT_THAT(KeysOf(visit), ElementsAre("board_unseen rear", "failed_pair front top"));
  visit.AddGood("front", "top");  // repaired since
  EXPECT_THAT(KeysOf(visit), ElementsAre("board_unseen rear"));
  EXPECT_THAT(CauseKeysOf({}, {}, {}), IsEmpty());
}

TEST(CauseKeys, BeyondWhatIsKeptSayThatThereAreMore) {
  Visit visit(StereoBoard());
  for (std::size_t i = 0; i < kCauseKeysMax; ++i)
    visit.AddFailed("top", "camera_" + std::to_string(i), "lidar_camera", "no_agreement");
  EXPECT_THAT(KeysOf(visit), SizeIs(kCauseKeysMax));
  EXPECT_EQ(KeysOf(visit).back().find("failed_pair "), 0u);
  visit.AddFailed("top", "another", "lidar_camera", "no_agreement");
  EXPECT_THAT(KeysOf(visit), SizeIs(kCauseKeysMax));
  EXPECT_EQ(KeysOf(visit).back(), kMoreCausesKey);
}

}  // namespace
}  // namespace rigcal::fleet
