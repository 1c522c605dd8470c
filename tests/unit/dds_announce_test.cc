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

TEST_F(AnnounceTest, EventsReachTheRobotsSubscribers) {
  const RobotId robot("mapper-01");
  server_->Announce({robot, "edge", "none", Stamp{1}, "{}"});  // makes the robot known; nobody hears it
  Listener<rigcal_wire_Event> listener(options_.participant, "robot/mapper-01");
  listener.WaitForServer();
  server_->Announce({robot, "revision", "17", Stamp{42}, "{\"revision\": 17}"});
  listener.Take(1, [](const rigcal_wire_Event& event) {
    EXPECT_STREQ(event.robot_id, "mapper-01");
    EXPECT_STREQ(event.kind, "revision");
    EXPECT_STREQ(event.subject_id, "17");
    EXPECT_EQ(event.stamp_ns, 42);
    EXPECT_STREQ(event.json, "{\"revision\": 17}");
  });
}

// Error on one axis, looked for at that index on the wire.
TEST_F(AnnounceTest, LateJoinersGetTheCalibration) {
  const RobotId robot("mapper-01");
  SensorPose left, right;
  left.sensor = SensorId("left");
  right.sensor = SensorId("right");
  right.known = true;
  right.T_ref_sensor.p_m = {1, 2, 3};
  right.T_ref_sensor.q = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5);
  right.covariance(4, 2) = 7;
  const Verdict verdict{VerdictLevel::kWarn, "why", "do"};
  server_->PublishCalibration(robot, 3, SensorId("left"), {left, right}, verdict, Stamp{42});
  server_->PublishStatus(robot, 3, verdict, 5, 6, Stamp{42});
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
        EXPECT_EQ(status.jobs_waiting, 6u);
        EXPECT_EQ(status.stamp_ns, 42);
      });
}

// What was withdrawn is gone for those who listen, and for those who come later; the others' stay.
TEST_F(AnnounceTest, LateJoinersGetNothingThatWasWithdrawn) {
  const RobotId robot("mapper-01");
  SensorPose left, right;
  left.sensor = SensorId("left");
  right.sensor = SensorId("right");
  const Verdict verdict{VerdictLevel::kPass, "why", "do"};
  server_->PublishCalibration(robot, 3, SensorId("left"), {left, right}, verdict, Stamp{42});
  server_->WithdrawCalibration(robot, {left, right});
  server_->PublishCalibration(robot, 4, SensorId("left"), {right}, verdict, Stamp{43});
  std::map<std::string, std::uint32_t> heard;
  Listener<rigcal_wire_Calibration>(options_.participant, "robot/mapper-01")
      .Take(1, [&](const rigcal_wire_Calibration& sample) { heard[sample.sensor_id] = sample.revision; });
  EXPECT_EQ(heard, (std::map<std::string, std::uint32_t>{{"right", 4}}));
}

}  // namespace
}  // namespace rigcal::dds
