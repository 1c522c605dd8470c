// For whom a robot has writers, and for how long.
#include "server/dds/tell/outbox.h"

#include <gmock/gmock.h>

#include <climits>
#include <functional>
#include <thread>
#include <utility>

#include "idl/discovery.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

const RobotId kRobotA("a"), kRobotB("b"), kRobotC("c");

class OutboxTest : public testing::Test {
 protected:
  static wire::ParticipantOptions Options() {
    wire::ParticipantOptions options;
    options.tag = RandomTag();
    return options;
  }
  template <typename T>
  wire::Reader<T> Reader(const std::string& partition) {
    return Must(wire::Reader<T>::Open(others_, {partition}));
  }
  // As thread D does.
  void LookWhoIsThere() {
    static_cast<void>(Must(readers_.TakePartitions(Outbox::Topics())));
    outbox_.NoteReadersOfMany(readers_.OfMany());
  }
  void Announce(const RobotId& robot) { outbox_.Send(Announcement{robot, "edge", "none", Stamp{1}, "{}"}); }
  void SendReceipt(const RobotId& robot) {
    wire::Receipt receipt;
    receipt.robot = robot;
    receipt.subject_id = Sha256Of("session").str();
    receipt.state = wire::ReceiptState::kReceiving;
    outbox_.Send(robot, receipt);
  }
  void After(seconds time) {
    now_ += time;
    outbox_.CloseQuiet();
  }
  // Of which robots something came.
  template <typename T>
  static std::vector<std::string> Take(wire::Reader<T>& reader) {
    std::vector<std::string> robots;
    Must(reader.Take(INT_MAX,
                     [&](const T& sample, const wire::SampleOrigin&) { robots.emplace_back(sample.robot_id); }));
    return robots;
  }

  const wire::ParticipantOptions options_ = Options();
  wire::Participant server_ = Must(wire::Participant::Open(options_)),
                    others_ = Must(wire::Participant::Open(options_));
  wire::NewReaders readers_ = Must(wire::NewReaders::Open(server_));
  Outbox::Time now_ = Outbox::Time(std::chrono::hours(1));
  std::vector<RobotId> met_;
  // Two robots that are listened to, one that has news.
  std::function<void()> on_clock_;
  Outbox outbox_{server_,
                 [this](const RobotId& robot) { met_.push_back(robot); },
                 {2, 1},
                 [this] {
                   if (on_clock_) std::exchange(on_clock_, {})();
                   return now_;
                 }};
};

TEST_F(OutboxTest, NewsTakeNoPlaceThatReceiptsNeed) {
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  for (const char* robot : {"x", "y", "z"}) Announce(RobotId(robot));
  EXPECT_THAT(Take(watch), ElementsAre("x"));
  for (const RobotId& robot : {kRobotA, kRobotB}) {
    auto receipts = Reader<rigcal_wire_Receipt>(wire::RobotPartition(robot));
    SendReceipt(robot);
    EXPECT_THAT(Take(receipts), ElementsAre(robot.str()));
  }
}

// All of DDS was opened anew: who listened before is met again only then.
TEST_F(OutboxTest, WhatIsAnnouncedWhileNobodyIsMetYetIsHeardAfterThat) {
  outbox_.HoldAnnouncements(seconds(5));
  Announce(kRobotA);
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  Announce(kRobotA);
  After(seconds(4));
  EXPECT_THAT(Take(watch), IsEmpty());
  After(seconds(2));
  EXPECT_THAT(Take(watch), ElementsAre("a", "a"));
  Announce(kRobotA);
  EXPECT_THAT(Take(watch), ElementsAre("a")) << "at once from then on";
}

// DDS is opened anew once more before they were heard: the next one tells them.
TEST_F(OutboxTest, WhatIsStillHeldCanBeTakenAndIsNotSentThen) {
  outbox_.HoldAnnouncements(seconds(5));
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  Announce(kRobotA);
  Announce(kRobotB);
  const std::deque<Announcement> held = outbox_.TakeHeld();
  ASSERT_EQ(held.size(), 2u);
  EXPECT_EQ(held.front().robot, kRobotA);
  EXPECT_EQ(held.back().robot, kRobotB);
  After(seconds(6));
  EXPECT_THAT(Take(watch), IsEmpty());
}

// Another thread sends while those that were held go out.
TEST_F(OutboxTest, NothingOvertakesWhatIsStillGoingOut) {
  constexpr int kHeld = 500;
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  const auto announce = [&](const std::string& subject) {
    outbox_.Send(Announcement{kRobotA, "edge", subject, Stamp{1}, "{}"});
  };
  outbox_.HoldAnnouncements(seconds(5));
  for (int i = 0; i < kHeld; ++i) announce("held");
  now_ += seconds(6);
  std::thread other;
  on_clock_ = [&] { other = std::thread([&] { announce("new"); }); };
  outbox_.CloseQuiet();
  other.join();
  std::vector<std::string> subjects;
  Must(watch.Take(INT_MAX, [&](const rigcal_wire_Event& sample, const wire::SampleOrigin&) {
    subjects.emplace_back(sample.subject_id);
  }));
  ASSERT_EQ(subjects.size(), kHeld + 1U);
  EXPECT_EQ(subjects.back(), "new");
}

TEST_F(OutboxTest, AFewSecondsAfterNewsAnotherRobotHasRoomForIts) {
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  Announce(kRobotA);
  After(seconds(4));
  Announce(kRobotB);
  EXPECT_THAT(Take(watch), ElementsAre("a"));
  After(seconds(2));
  Announce(kRobotB);
  EXPECT_THAT(Take(watch), ElementsAre("b"));
}

TEST_F(OutboxTest, WhoReadsOfManyRobotsKeepsNoWriters) {
  auto watch = Reader<rigcal_wire_Event>("robot/?");
  LookWhoIsThere();
  outbox_.Meet(kRobotA);
  outbox_.Meet(kRobotB);
  outbox_.Meet(kRobotC);
  EXPECT_THAT(met_, ElementsAre(kRobotA, kRobotB)) << "there are two places";
  auto own = Reader<rigcal_wire_RobotStatus>("robot/a");
  After(seconds(6));
  outbox_.Meet(kRobotA);
  outbox_.Meet(kRobotC);
  EXPECT_THAT(met_, ElementsAre(kRobotA, kRobotB, kRobotC)) << "nobody but the watch read of b";
}

TEST_F(OutboxTest, OfARobotThatHadNewsWhoBeginsToReadIsMet) {
  auto watch = Reader<rigcal_wire_Event>("robot/*");
  LookWhoIsThere();
  Announce(kRobotA);
  EXPECT_THAT(met_, IsEmpty());
  outbox_.Meet(kRobotA);
  EXPECT_THAT(met_, ElementsAre(kRobotA));
  Announce(kRobotA);
  Announce(kRobotB);
  EXPECT_THAT(Take(watch), ElementsAre("a", "a", "b"));
}

// DDS tells of a reader first, and matches it then.
TEST_F(OutboxTest, WritersWaitForAReaderThatIsToBeMatched) {
  SendReceipt(kRobotA);
  now_ += seconds(6);
  outbox_.Meet(kRobotA);
  After(seconds(0));
  auto receipts = Reader<rigcal_wire_Receipt>("robot/a");
  EXPECT_THAT(Take(receipts), ElementsAre("a"));
}

TEST_F(OutboxTest, NobodyHearsOfRobotsOnceWhoReadOfManyIsGone) {
  EXPECT_FALSE(outbox_.IsHeardOf(kRobotA));
  {
    auto watch = Reader<rigcal_wire_Event>("robot/not-a-*");
    auto requests = Reader<rigcal_wire_Request>("robot/*");  // of another kind
    LookWhoIsThere();
    EXPECT_EQ(readers_.OfMany().size(), 1u);
    EXPECT_TRUE(outbox_.IsHeardOf(kRobotA));
  }
  LookWhoIsThere();
  EXPECT_FALSE(outbox_.IsHeardOf(kRobotA));
  outbox_.Meet(kRobotA);
  EXPECT_TRUE(outbox_.IsHeardOf(kRobotA));
  EXPECT_FALSE(outbox_.IsHeardOf(kRobotB));
}

}  // namespace
}  // namespace rigcal::dds
