// Epochs of sensors: by parts that sessions name, in whatever order the sessions come, and by what people say.
#include "storage/sessions/epochs.h"

#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "storage/audit.h"
#include "storage/sessions/retired.h"
#include "storage/settings/rig_models.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const Word kAda{{500}, "Ada", "new bracket"};

class EpochsTest : public StoreTest {
 protected:
  // A closed session of its own pictures, captured at that time, with these parts of the left sensor.
  SessionId Visit(std::int64_t captured_ns, const std::string& serial, const std::string& firmware = "",
                  int pictures = 0) {
    Manifest manifest = MakeManifest(2);
    manifest.header.captured_at = {captured_ns};
    manifest.header.sensors[0].serial = serial;
    manifest.header.sensors[0].firmware = firmware;
    const std::string about = std::to_string(pictures > 0 ? pictures : static_cast<int>(++visits_) * 100);
    for (Payload& payload : manifest.payloads) payload.digest = DigestOf(payload.path + about);
    const std::string text = formats::WriteManifest(manifest);
    const SessionId id(Sha256Of(text).str());
    EXPECT_TRUE(AppendSession(store_, id, text, manifest, {captured_ns}));
    EXPECT_TRUE(AppendHeld(store_, id, {0, 1}, {captured_ns}));
    EXPECT_TRUE(CloseSession(store_, id, {}, {captured_ns}));
    return id;
  }
  std::vector<std::string> Told() {
    std::vector<std::string> told;
    const auto epochs = LoadEpochs(store_, kRobot);
    EXPECT_TRUE(epochs) << WordsOf(epochs);
    for (const Epoch& epoch : epochs.value_or(std::vector<Epoch>()))
      told.push_back(std::to_string(epoch.begins_at.ns) + " " + TextOf(epoch));
    return told;
  }
  Status Begin(Stamp at, const Word& word = kAda) {
    return store_.Write([&] { return BeginEpoch(store_, kRobot, {SensorId("left")}, at, word); });
  }

  std::size_t visits_ = 0;
};

TEST_F(EpochsTest, AnotherSerialNumberBeginsOne) {
  Visit(10, "A1");
  Visit(20, "A1");
  EXPECT_THAT(Told(), IsEmpty());
  const SessionId third = Visit(30, "B7");
  EXPECT_THAT(Told(), ElementsAre("30 the serial number of left is B7, before it was A1"));
  EXPECT_EQ(LoadEpochs(store_, kRobot)->front().session, third);
  Visit(40, "A1");
  EXPECT_THAT(Told(), SizeIs(2)) << "it was put back";
}

TEST_F(EpochsTest, WhatWasNotToldDiffersFromNothing) {
  Visit(10, "");
  Visit(20, "A1");
  Visit(30, "");
  Visit(40, "A1");
  EXPECT_THAT(Told(), IsEmpty());
  Visit(50, "B7");
  EXPECT_THAT(Told(), SizeIs(1));
}

TEST_F(EpochsTest, AnotherFirmwareBeginsOne) {
  Visit(10, "A1", "2.3");
  Visit(20, "A1", "2.4");
  EXPECT_THAT(Told(), ElementsAre("20 the firmware of left is 2.4, before it was 2.3"));
  Visit(30, "B7", "1.0");
  EXPECT_THAT(Told(), SizeIs(2)) << "another part has a firmware of its own";
}

TEST_F(EpochsTest, TheOrderOfArrivalDoesNotMatter) {
  Visit(30, "B7");
  Visit(10, "A1");
  Visit(20, "A1");
  EXPECT_THAT(Told(), ElementsAre("30 the serial number of left is B7, before it was A1"));
}

TEST_F(EpochsTest, ACorrectedSessionTakesItsEpochWithIt) {
  Visit(10, "A1");
  Visit(20, "A7", "", 7);
  EXPECT_THAT(Told(), SizeIs(1));
  Visit(20, "A1", "", 7);  // the same pictures
  EXPECT_THAT(Told(), IsEmpty());
}

TEST_F(EpochsTest, ARetiredSessionTellsNothingOfParts) {
  Visit(10, "A1");
  const SessionId of_another = Visit(20, "Z9");
  ASSERT_TRUE(RetireSession(store_, of_another, {{90}, "Ada", "of another robot"}));
  EXPECT_THAT(Told(), IsEmpty());
}

TEST_F(EpochsTest, APersonBeginsOneAndTakesItBack) {
  Visit(10, "A1");
  ASSERT_TRUE(Begin({400}));
  EXPECT_THAT(Told(), ElementsAre("400 an epoch of left was begun by Ada: new bracket"));
  ASSERT_TRUE(Begin({400}));
  EXPECT_THAT(Told(), SizeIs(1)) << "said twice it was said once";
  ASSERT_TRUE(Begin({450}));
  EXPECT_THAT(Told(), SizeIs(2));
  const auto taken =
      TakeBackEpoch(store_, kRobot, {SensorId("left"), SensorId("right")}, {{600}, "Eve", "not this robot"});
  ASSERT_TRUE(taken) << WordsOf(taken);
  ASSERT_THAT(*taken, SizeIs(1));
  EXPECT_EQ(taken->front().begins_at, Stamp{450});
  EXPECT_THAT(Told(), SizeIs(1));
  EXPECT_THAT(*TakeBackEpoch(store_, kRobot, {SensorId("left")}, {{600}, "Eve", "nor then"}), SizeIs(1));
  EXPECT_THAT(*TakeBackEpoch(store_, kRobot, {SensorId("left")}, {{600}, "Eve", "nor then"}), IsEmpty());
  EXPECT_THAT(Told(), IsEmpty());
  const auto audit = LoadAudit(store_, kRobot);
  ASSERT_THAT(*audit, SizeIs(4));
  EXPECT_THAT(audit->back().what, HasSubstr("began an epoch of left of robot mapper-01 at "));
  EXPECT_THAT(audit->front().what, HasSubstr("took back the epoch of left"));
}

TEST_F(EpochsTest, OneThatIsStillToComeIsRefused) {
  Visit(10, "A1");
  EXPECT_EQ(Begin({501}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Begin({400}, {{500}, "Ada", "two\nlines"}).error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(Told(), IsEmpty());
}

// The sensor is as it was: neither retired nor restored.
TEST_F(EpochsTest, AnEpochIsNoWordAboutWhetherASensorIsThere) {
  Visit(10, "A1");
  ASSERT_TRUE(Begin({400}));
  EXPECT_THAT(*LoadRetiredSensors(store_, kRobot), IsEmpty());
  EXPECT_FALSE(LoadStanding(store_, kRobot, SensorId("left")).value());
  ASSERT_TRUE(RetireSensor(store_, kRobot, SensorId("left"), kAda));
  ASSERT_TRUE(Begin({420}));
  EXPECT_THAT(*LoadRetiredSensors(store_, kRobot), SizeIs(1));
  EXPECT_EQ(LoadStanding(store_, kRobot, SensorId("left")).value()->how, "retired");
}

using RigModelsTest = EpochsTest;

TEST_F(RigModelsTest, EachIsAnotherVersionOfItsName) {
  EXPECT_FALSE(LoadRigModelVersion(store_, "mars").value());
  EXPECT_EQ(LoadRigModelWatermark(store_).value(), 0);
  EXPECT_EQ(AppendRigModel(store_, "mars", "one", kAda)->version, 1);
  EXPECT_EQ(AppendRigModel(store_, "moon", "other", kAda)->version, 1);
  EXPECT_EQ(AppendRigModel(store_, "mars", "two", kAda)->version, 2);
  EXPECT_EQ(AppendRigModel(store_, "mars", "two", kAda)->version, 2) << "the same text is no other version";
  EXPECT_EQ(LoadRigModelVersion(store_, "mars").value()->text, "two");
  EXPECT_EQ(LoadRigModelWatermark(store_).value(), 3);
  const auto all = LoadRigModelVersions(store_, 10);
  ASSERT_THAT(*all, SizeIs(2));
  EXPECT_EQ(all->front().name, "mars");
  EXPECT_EQ(all->front().version, 2);
  EXPECT_THAT(*LoadRigModelVersions(store_, 1), SizeIs(1));
}

TEST_F(RigModelsTest, ARobotIsOfTheModelThatItsNewestSessionNames) {
  Visit(10, "A1");
  EXPECT_THAT(*LoadRobotsOfModel(store_, "stereo-rig", 10), ElementsAre(kRobot));
  Manifest manifest = MakeManifest(3);
  manifest.header.captured_at = {2'000'000'000'000'000'000};
  manifest.header.rig_model = "moon";
  const std::string text = formats::WriteManifest(manifest);
  const SessionId id(Sha256Of(text).str());
  ASSERT_TRUE(AppendSession(store_, id, text, manifest, {20}));
  ASSERT_TRUE(AppendHeld(store_, id, {0, 1, 2}, {20}));
  ASSERT_TRUE(CloseSession(store_, id, {}, {20}));
  EXPECT_THAT(*LoadRobotsOfModel(store_, "stereo-rig", 10), IsEmpty());
  EXPECT_THAT(*LoadRobotsOfModel(store_, "moon", 10), ElementsAre(kRobot));
}

}  // namespace
}  // namespace rigcal::storage
