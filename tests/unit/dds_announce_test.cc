#include <gmock/gmock.h>

#include "tests/unit/dds_fixture.h"

namespace rigcal::dds {
namespace {

using AnnounceTest = ServiceTest;

template <typename T>
class Listener {
 public:
  Listener(const wire::ParticipantOptions& options, const std::string& partition)
      : participant_(Must(wire::Participant::Open(options))),
        reader_(Must(wire::Reader<T>::Open(participant_, {partition}))),
        waitset_(Must(wire::WaitSet::Open(participant_))) {
    Must(waitset_.Attach(reader_.get()));
  }
  void WaitForServer() { Must(reader_.WaitForWriter(kPatience)); }
  template <typename Body>
  void Take(int count, const Body& body) {
    while (count > 0) {
      if (!Must(waitset_.Wait(kPatience))) throw std::runtime_error("nothing came");
      count -= Must(reader_.Take(count, [&](const T& sample, const wire::SampleOrigin&) { body(sample); }));
    }
  }

 private:
  wire::Participant participant_;
  wire::Reader<T> reader_;
  wire::WaitSet waitset_;
};

const RobotId kMapper("mapper-01");

SensorPose PoseOf(const char* sensor) {
  SensorPose pose;
  pose.sensor = SensorId(sensor);
  return pose;
}

RobotState StateOf(int revision, const Verdict& verdict, std::vector<SensorPose> poses) {
  RobotState state;
  state.newest.robot = kMapper;
  state.newest.number = revision;
  state.newest.created_at = Stamp{40 + revision};
  state.newest.verdict = verdict;
  state.edges = 5;
  if (!poses.empty()) state.calibration = {state.newest, SensorId("left"), std::move(poses)};
  return state;
}

TEST_F(AnnounceTest, EventsReachTheRobotsSubscribers) {
  server_->Announce({kMapper, "edge", "none", Stamp{1}, "{}"});  // nobody hears it
  Listener<rigcal_wire_Event> listener(options_.participant, "robot/mapper-01");
  listener.WaitForServer();
  server_->Announce({kMapper, "revision", "17", Stamp{42}, "{\"revision\": 17}"});
  listener.Take(1, [](const rigcal_wire_Event& event) {
    EXPECT_STREQ(event.robot_id, "mapper-01");
    EXPECT_STREQ(event.kind, "revision");
    EXPECT_STREQ(event.subject_id, "17");
    EXPECT_EQ(event.stamp_ns, 42);
    EXPECT_STREQ(event.json, "{\"revision\": 17}");
  });
}

// Error on one axis, looked for at that index on the wire. Told before anybody listens: it comes from the store.
TEST_F(AnnounceTest, LateJoinersGetTheCalibration) {
  SensorPose left = PoseOf("left"), right = PoseOf("right");
  right.known = true;
  right.T_ref_sensor.p_m = {1, 2, 3};
  right.T_ref_sensor.q = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5);
  right.covariance(4, 2) = 7;
  StoreAndTell(StateOf(3, {VerdictLevel::kWarn, "why", "do"}, {left, right}));
  std::map<std::string, rigcal_wire_Calibration> heard;
  Listener<rigcal_wire_Calibration>(options_.participant, "robot/mapper-01")
      .Take(2, [&](const rigcal_wire_Calibration& sample) { heard[sample.sensor_id] = sample; });
  EXPECT_FALSE(heard.at("left").known);
  EXPECT_EQ(heard.at("left").q_xyzw[3], 1.0);
  const rigcal_wire_Calibration& sample = heard.at("right");
  EXPECT_TRUE(sample.known);
  EXPECT_STREQ(sample.reference_id, "left");
  EXPECT_STREQ(sample.verdict, "warn");
  EXPECT_EQ(sample.revision, 3u);
  EXPECT_EQ(sample.p_m[1], 2.0);
  EXPECT_EQ(sample.q_xyzw[1], -0.7);
  EXPECT_EQ(sample.q_xyzw[3], 0.5);
  EXPECT_EQ(sample.covariance[6 * 4 + 2], 7.0);
  EXPECT_EQ(sample.covariance[6 * 2 + 4], 0.0);
  Listener<rigcal_wire_RobotStatus>(options_.participant, "robot/mapper-01")
      .Take(1, [](const rigcal_wire_RobotStatus& status) {
        EXPECT_EQ(status.revision, 3u);
        EXPECT_STREQ(status.why, "why");
        EXPECT_EQ(status.edges, 5u);
        EXPECT_EQ(status.stamp_ns, 43);
      });
}

// While somebody listens the writers keep what was told: who joins then hears the newest, and nothing that was withdrawn.
TEST_F(AnnounceTest, LateJoinersGetNothingThatWasWithdrawn) {
  const Verdict pass{VerdictLevel::kPass, "why", "do"};
  Listener<rigcal_wire_RobotStatus> keeps_it_open(options_.participant, "robot/mapper-01");
  keeps_it_open.WaitForServer();
  StoreAndTell(StateOf(3, pass, {PoseOf("left"), PoseOf("right")}));
  StoreAndTell(StateOf(4, {VerdictLevel::kFail, "why", "do"}, {}));
  StoreAndTell(StateOf(5, pass, {PoseOf("right")}));
  std::map<std::string, std::uint32_t> heard;
  Listener<rigcal_wire_Calibration>(options_.participant, "robot/mapper-01")
      .Take(1, [&](const rigcal_wire_Calibration& sample) { heard[sample.sensor_id] = sample.revision; });
  EXPECT_EQ(heard, (std::map<std::string, std::uint32_t>{{"right", 5}}));
}

// Two threads may tell: what one of them loaded before the other's revision changes nothing.
TEST_F(AnnounceTest, AnOlderStateIsNotTold) {
  const Verdict pass{VerdictLevel::kPass, "why", "do"};
  Listener<rigcal_wire_RobotStatus> listener(options_.participant, "robot/mapper-01");
  listener.WaitForServer();
  server_->Tell(StateOf(4, pass, {PoseOf("right")}));
  server_->Tell(StateOf(3, pass, {PoseOf("right")}));
  std::vector<std::uint32_t> heard;
  const auto note = [&](const rigcal_wire_RobotStatus& status) { heard.push_back(status.revision); };
  listener.Take(1, note);
  server_->Tell(StateOf(5, pass, {PoseOf("right")}));
  listener.Take(1, note);
  EXPECT_EQ(heard, (std::vector<std::uint32_t>{4, 5}));
}

// Who reads of all robots at once hears of each that has news, though none of them has a reader of its own.
TEST_F(AnnounceTest, WhoListensToTheFleetHearsOfEachRobotWithNews) {
  Listener<rigcal_wire_RobotStatus> listener(options_.participant, "robot/*");
  server_->Tell(StateOf(1, {VerdictLevel::kPass, "why", "do"}, {}));  // nobody may be known to listen yet
  listener.WaitForServer();
  StoreAndTell(StateOf(2, {VerdictLevel::kPass, "why", "do"}, {}));
  std::uint32_t heard = 0;
  while (heard < 2) listener.Take(1, [&](const rigcal_wire_RobotStatus& status) { heard = status.revision; });
}

}  // namespace
}  // namespace rigcal::dds
