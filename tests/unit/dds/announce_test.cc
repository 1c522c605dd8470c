#include <gmock/gmock.h>

#include <atomic>
#include <climits>
#include <future>
#include <utility>

#include "tests/unit/dds/fixture.h"

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
  // What comes within that time.
  template <typename Body>
  void TakeFor(milliseconds patience, const Body& body) {
    if (!Must(waitset_.Wait(patience))) return;
    Must(reader_.Take(INT_MAX, [&](const T& sample, const wire::SampleOrigin&) { body(sample); }));
  }

 private:
  wire::Participant participant_;
  wire::Reader<T> reader_;
  wire::WaitSet waitset_;
};

// What a robot's computer holds of its calibration: the revision of each sensor's pose; 0: it was taken back.
class Holder {
 public:
  using Held = std::map<std::string, std::uint32_t>;
  explicit Holder(const wire::ParticipantOptions& options)
      : participant_(Must(wire::Participant::Open(options))),
        reader_(Must(wire::Reader<rigcal_wire_Calibration>::Open(participant_, {"robot/mapper-01"}))),
        waitset_(Must(wire::WaitSet::Open(participant_))) {
    Must(waitset_.Attach(reader_.get()));
  }
  // Until it holds that, or too long has passed; what it holds.
  const Held& Await(const Held& wanted) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (held_ != wanted && std::chrono::steady_clock::now() < deadline) {
      static_cast<void>(Must(waitset_.Wait(milliseconds(200))));
      Must(wire::internal::TakeNews(reader_.get(), INT_MAX, [&](const void* sample, const dds_sample_info_t& info) {
        const auto& pose = *static_cast<const rigcal_wire_Calibration*>(sample);
        if (info.instance_state == DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE)
          held_[pose.sensor_id] = 0;
        else if (info.valid_data)
          held_[pose.sensor_id] = pose.revision;
      }));
    }
    return held_;
  }

 private:
  wire::Participant participant_;
  wire::Reader<rigcal_wire_Calibration> reader_;
  wire::WaitSet waitset_;
  Held held_;
};

const RobotId kMapper("mapper-01");
const Verdict kPass{VerdictLevel::kPass, "why", "do"}, kFail{VerdictLevel::kFail, "why", "do"};

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

// Who needs a whole pose finds none; what was measured stands beside it.
TEST_F(AnnounceTest, APoseInPartIsToldAsSuch) {
  SensorPose pose = PoseOf("lidar");
  pose.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  pose.measured_part = MeasuredPart{};
  pose.measured_part->T_ref_sensor.p_m = {1, 2, 3};
  pose.measured_part->covariance(0, 0) = 4e-6;
  StoreAndTell(StateOf(3, {VerdictLevel::kWarn, "why", "do"}, {pose}));
  int heard = 0;
  Listener<rigcal_wire_Calibration>(options_.participant, "robot/mapper-01")
      .Take(1, [&](const rigcal_wire_Calibration& sample) {
        ++heard;
        EXPECT_FALSE(sample.known);
        EXPECT_EQ(sample.p_m[0], 0.0);
        ASSERT_EQ(sample.measured_part._length, 1u);
        const rigcal_wire_MeasuredPart& part = sample.measured_part._buffer[0];
        EXPECT_EQ(part.p_m[0], 1.0);
        ASSERT_EQ(part.axes._length, 6u);
        EXPECT_NEAR(part.axes._buffer[0].sigma_m, 2e-3, 1e-12);
        EXPECT_STREQ(part.axes._buffer[2].name, "z");
        EXPECT_FALSE(part.axes._buffer[2].measured);
      });
  EXPECT_EQ(heard, 1);
}

// While somebody listens the writers keep what was told: who joins then hears the newest, and that the rest was
// withdrawn.
TEST_F(AnnounceTest, LateJoinersGetNothingThatWasWithdrawn) {
  Holder robot(options_.participant);
  StoreAndTell(StateOf(3, kPass, {PoseOf("left"), PoseOf("right")}));
  EXPECT_EQ(robot.Await({{"left", 3}, {"right", 3}}), (Holder::Held{{"left", 3}, {"right", 3}}));
  StoreAndTell(StateOf(4, kFail, {}));
  EXPECT_EQ(robot.Await({{"left", 0}, {"right", 0}}), (Holder::Held{{"left", 0}, {"right", 0}}));
  StoreAndTell(StateOf(5, kPass, {PoseOf("right")}));
  EXPECT_EQ(robot.Await({{"left", 0}, {"right", 5}}), (Holder::Held{{"left", 0}, {"right", 5}}));
  Holder late(options_.participant);
  EXPECT_EQ(late.Await({{"left", 0}, {"right", 5}}), (Holder::Held{{"left", 0}, {"right", 5}}));
}

// As after a kill between the commit of a revision and its announcement: nobody else knows what the robot holds.
TEST_F(AnnounceTest, WhatAnEarlierServerToldIsTakenBack) {
  Holder robot(options_.participant);
  StoreAndTell(StateOf(3, kPass, {PoseOf("left"), PoseOf("right")}));
  EXPECT_EQ(robot.Await({{"left", 3}, {"right", 3}}), (Holder::Held{{"left", 3}, {"right", 3}}));
  StopServer();
  RobotState remounted = StateOf(4, kFail, {});
  remounted.withdrawn = {SensorId("left"), SensorId("right")};
  StoreState(remounted);
  StartServer();
  EXPECT_EQ(robot.Await({{"left", 0}, {"right", 0}}), (Holder::Held{{"left", 0}, {"right", 0}}));
  Holder back(options_.participant);  // one that was cut off meanwhile
  EXPECT_EQ(back.Await({{"left", 0}, {"right", 0}}), (Holder::Held{{"left", 0}, {"right", 0}}));
}

// Another revision is stored, and told of, while what was stored before is loaded for who just came.
TEST_F(AnnounceTest, NothingOlderIsToldAfterwards) {
  std::atomic<bool> is_first = true;
  state_of_ = [&](const RobotId& robot) {
    auto loaded = LoadState(robot);
    if (is_first.exchange(false)) StoreAndTell(StateOf(4, kPass, {PoseOf("right")}));
    return loaded;
  };
  StoreState(StateOf(3, kPass, {PoseOf("right")}));
  Listener<rigcal_wire_RobotStatus> listener(options_.participant, "robot/mapper-01");
  std::vector<std::uint32_t> heard = {0};
  const auto note = [&](const rigcal_wire_RobotStatus& status) { heard.push_back(status.revision); };
  while (heard.back() < 4) listener.Take(1, note);
  StoreAndTell(StateOf(5, kPass, {PoseOf("right")}));
  while (heard.back() < 5) listener.Take(1, note);
  EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end())) << testing::PrintToString(heard);
}

TEST_F(AnnounceTest, WhatCannotBeLoadedIsToldOnceItCan) {
  std::atomic<int> loads = 0;
  state_of_ = [&](const RobotId& robot) -> Result<std::optional<RobotState>> {
    if (++loads == 1) return Fail(ErrorCode::kBusy, "another process holds the database", "Wait");
    return LoadState(robot);
  };
  StoreState(StateOf(3, kPass, {PoseOf("right")}));
  Listener<rigcal_wire_RobotStatus>(options_.participant, "robot/mapper-01")
      .Take(1, [](const rigcal_wire_RobotStatus& status) { EXPECT_EQ(status.revision, 3u); });
  EXPECT_EQ(loads, 2);
}

// It is seen where people look at how the server is, as long as it lasts; that another robot is told changes nothing.
TEST_F(AnnounceTest, ARobotThatIsNotToldIsAProblemUntilItIs) {
  StopServer();
  Vitals vitals{SystemClock()};
  const auto problem = [&vitals] {
    for (const PartState& part : vitals.States())
      if (part.name == "robot states") return part.problem;
    return std::optional<Error>();
  };
  std::atomic<int> loads = 0;
  std::optional<Error> at_first, meanwhile, at_last;  // of thread T, which is joined before they are read
  state_of_ = [&](const RobotId& robot) -> Result<std::optional<RobotState>> {
    if (robot != kMapper) {
      meanwhile = problem();
      return LoadState(robot);
    }
    if (++loads == 1) {
      at_first = problem();
      server_->Tell(RobotId("mapper-02"));
      return Fail(ErrorCode::kBusy, "another process holds the database", "Wait");
    }
    at_last = problem();
    return LoadState(robot);
  };
  StoreState(StateOf(3, kPass, {PoseOf("right")}));
  options_.vitals = &vitals;
  StartServer();
  Listener<rigcal_wire_RobotStatus> other(options_.participant, "robot/mapper-02");
  other.WaitForServer();
  Listener<rigcal_wire_RobotStatus>(options_.participant, "robot/mapper-01").Take(1, [](const auto&) {});
  StopServer();
  EXPECT_FALSE(at_first);
  ASSERT_TRUE(meanwhile && at_last);
  EXPECT_EQ(meanwhile->what, "the state of a robot could not be told: another process holds the database");
  EXPECT_EQ(at_last->what, meanwhile->what);
  EXPECT_FALSE(problem()) << problem()->what;
}

TEST_F(AnnounceTest, ReceiptsDoNotWaitForStatesToBeLoaded) {
  std::promise<void> loaded;
  state_of_ = [&, may_end = loaded.get_future().share()](const RobotId& robot) {
    may_end.wait();
    return LoadState(robot);
  };
  Listener<rigcal_wire_RobotStatus> listener(options_.participant, "robot/mapper-02");
  listener.WaitForServer();
  const Session session = MakeSession("mapper-01", {1000}, 1);
  Client client = MakeClient("mapper-01");
  EXPECT_EQ(client.Push(session).state, wire::ReceiptState::kClosed);
  loaded.set_value();
}

// Who reads of many robots at once hears of each that has news, though none of them has a reader of its own.
TEST_F(AnnounceTest, WhoListensToManyRobotsHearsOfEachWithNews) {
  int revision = 0;
  for (const char* robots : {"robot/mapper-*", "robot/mapper-0?", "robot/*"}) {
    Listener<rigcal_wire_RobotStatus> listener(options_.participant, robots);
    const int first = revision + 1;
    int heard = 0;
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (heard < first && std::chrono::steady_clock::now() < deadline) {  // the server may not know of it yet
      StoreAndTell(StateOf(++revision, kPass, {}));
      listener.TakeFor(milliseconds(50), [&](const auto& status) { heard = static_cast<int>(status.revision); });
    }
    EXPECT_GE(heard, first) << robots;
  }
}

}  // namespace
}  // namespace rigcal::dds
