// Visits that drift is learnt from: those of which the session counts now.
#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "storage/alerts/revision_status.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;

class ModelVisitsTest : public StoreTest {
 protected:
  // A closed session of so many pictures, and a revision of what it found; `note` makes it another one of the same
  // pictures.
  SessionId Visit(std::size_t pictures, const std::string& note, const RobotId& robot = kRobot) {
    Manifest manifest = MakeManifest(pictures, robot);
    manifest.header.operator_name = note;
    const std::string text = formats::WriteManifest(manifest);
    const SessionId id(Sha256Of(text).str());
    std::vector<std::uint32_t> all(manifest.payloads.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    const Status done = store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendSession(store_, id, text, manifest, {1}));
      RIGCAL_TRY(AppendHeld(store_, id, all, {1}));
      RIGCAL_TRY(CloseSession(store_, id, {}, {1}));
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(revisions_++, robot)));
      return AppendModelVisit(store_, "mars", {robot, number}, id);
    });
    EXPECT_TRUE(done) << WordsOf(done.error());
    return id;
  }
  std::vector<std::string> Visits(const std::string& model, const RobotId& robot = {}, int max = 9) {
    std::vector<std::string> visits;
    const auto loaded = LoadModelVisits(store_, model, robot, max);
    EXPECT_TRUE(loaded) << WordsOf(loaded);
    for (const RevisionKey& key : *loaded) visits.push_back(key.robot.str() + " " + std::to_string(key.number));
    return visits;
  }
  std::int64_t revisions_ = 1;
};

TEST_F(ModelVisitsTest, ASupersededSessionIsNone) {
  const SessionId bumped = Visit(4, "bumped");
  Visit(4, "of another robot", kOtherRobot);
  EXPECT_THAT(Visits("mars"), ElementsAre("mapper-01 1", "mapper-02 1"));
  Visit(4, "remounted");
  EXPECT_THAT(Visits("mars"), ElementsAre("mapper-02 1", "mapper-01 2"));
  EXPECT_THAT(Visits("", kRobot), ElementsAre("mapper-01 2"));
  EXPECT_THAT(Visits("mars", {}, 1), ElementsAre("mapper-01 2"));
  ASSERT_TRUE(MakeCurrent(store_, bumped, MadeCurrent::kRestored, {{9}, "Ada", "it was a bump"}));
  EXPECT_THAT(Visits("", kRobot), ElementsAre("mapper-01 1"));
}

TEST_F(ModelVisitsTest, ARetiredSessionIsNoneUntilItIsRestored) {
  const SessionId first = Visit(4, "first");
  Visit(4, "of another robot", kOtherRobot);
  ASSERT_TRUE(RetireSession(store_, first, {{9}, "Ada", "wrong board"}));
  EXPECT_THAT(Visits("mars"), ElementsAre("mapper-02 1"));
  EXPECT_THAT(Visits("", kRobot), ElementsAre());
  ASSERT_TRUE(MakeCurrent(store_, first, MadeCurrent::kRestored, {{10}, "Ada", "it was right"}));
  EXPECT_THAT(Visits("mars"), ElementsAre("mapper-01 1", "mapper-02 1"));
}

}  // namespace
}  // namespace rigcal::storage
