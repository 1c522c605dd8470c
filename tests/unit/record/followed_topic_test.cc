// What people are told of a topic, by what discovery and readers say.
#include "client/record/followed_topic.h"

#include <gmock/gmock.h>

namespace rigcal::recording {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kS = 1'000'000'000;
constexpr const char* kPicture = "sensor_msgs/msg/Image";

class Followed : public testing::Test {
 protected:
  // A publisher that discovery met.
  const wire::RosPublisher& Meet(dds_instance_handle_t handle, const std::string& type, bool reliable = true,
                                 const std::string& topic = "/left") {
    return met_[handle] = {{topic, type}, {reliable, false, 0}, true};
  }
  [[nodiscard]] Surroundings At(std::int64_t now_s) const { return {now_s * kS, 0, 42, &met_}; }

  std::map<dds_instance_handle_t, wire::RosPublisher> met_;
  std::vector<std::string> said_;
  FollowedTopic left_{{"/left", {"left"}, {bags::MessageKind::kImage}},
                      [this](const std::string& text) { said_.push_back(text); }};
};

TEST_F(Followed, NobodyIsSaidOnceWithWhatIsNear) {
  left_.TellTroubles(At(4));
  EXPECT_THAT(said_, testing::IsEmpty()) << "discovery takes its time";
  (void)Meet(1, kPicture, true, "/letf");
  left_.TellTroubles(At(6));
  left_.TellTroubles(At(7));
  EXPECT_THAT(said_, ElementsAre("nobody publishes /left (left): did you mean /letf? (1 other topics are published in "
                                 "ROS domain 42). It is waited for."));
  EXPECT_EQ(left_.Look(At(8)).state, TopicState::kNobody);
}

TEST_F(Followed, AnEmptyDomainIsSaidToBeEmpty) {
  left_.TellTroubles(At(6));
  EXPECT_THAT(said_, ElementsAre(HasSubstr("no topic at all is published in ROS domain 42: check --ros-domain")));
}

TEST_F(Followed, AnotherTypeIsRefusedAndNotMissed) {
  EXPECT_FALSE(left_.Come(1, Meet(1, "sensor_msgs/msg/PointCloud2"), kS));
  EXPECT_FALSE(left_.Come(2, Meet(2, "sensor_msgs/msg/PointCloud2"), kS));
  left_.TellTroubles(At(9));
  EXPECT_THAT(said_, ElementsAre(HasSubstr("/left (left) is published as sensor_msgs/msg/PointCloud2, and rig.yaml's "
                                           "sensor takes sensor_msgs/msg/Image")));
  const TopicSeen seen = left_.Look(At(9));
  EXPECT_EQ(seen.state, TopicState::kOtherType);
  EXPECT_THAT(seen.types, testing::Contains("sensor_msgs/msg/PointCloud2"));
  EXPECT_TRUE(left_.Come(3, Meet(3, kPicture), 9 * kS));
  EXPECT_THAT(left_.Look(At(9)).types, ElementsAre(kPicture)) << "what is recorded, and no more";
}

TEST_F(Followed, APublisherThatEndsAndComesAgain) {
  EXPECT_TRUE(left_.Come(1, Meet(1, kPicture), kS));
  left_.Arrive(2 * kS, 10, 1, 1);
  EXPECT_EQ(left_.Look(At(2)).state, TopicState::kRecorded);
  left_.End(1);
  EXPECT_EQ(left_.Look(At(3)).state, TopicState::kEnded);
  EXPECT_TRUE(left_.Come(2, Meet(2, kPicture), 4 * kS));
  left_.End(7);  // of another topic
  EXPECT_THAT(said_, ElementsAre("/left (left): its publisher ended after 1 messages; one that comes is recorded on.",
                                 "/left (left): a publisher is there again, and is recorded on."));
}

TEST_F(Followed, TwoAtOnceAndBestEffortAreSaid) {
  EXPECT_TRUE(left_.Come(1, Meet(1, kPicture), kS));
  EXPECT_TRUE(left_.Come(2, Meet(2, kPicture, false), kS));
  EXPECT_THAT(said_, ElementsAre(HasSubstr("2 publishers at once"), HasSubstr("best effort")));
  const TopicSeen seen = left_.Look(At(2));
  EXPECT_TRUE(seen.best_effort);
  EXPECT_EQ(seen.publishers, 2U);
  left_.End(1);
  EXPECT_EQ(said_.size(), 2U) << "one is left";
}

TEST_F(Followed, SilenceAStallAndLossesAreSaid) {
  EXPECT_TRUE(left_.Come(1, Meet(1, kPicture), kS));
  left_.TellTroubles(At(7));
  EXPECT_EQ(left_.Look(At(7)).state, TopicState::kSilent);
  for (int k = 0; k < 10; ++k) left_.Arrive(8 * kS + k * kS / 10, 10, 1, 1 + 2 * k);
  left_.Drop();
  left_.TellTroubles(At(9));
  left_.TellTroubles(At(12));
  EXPECT_EQ(left_.Look(At(12)).state, TopicState::kStalled);
  left_.Arrive(13 * kS, 10, 1, 0);
  left_.TellTroubles(At(13));
  EXPECT_THAT(said_,
              ElementsAre(HasSubstr("sends nothing"), HasSubstr("lost on the way, as its publisher does not keep them"),
                          HasSubstr("the disk does not keep up"), "/left (left): nothing for 3.1 s.",
                          "/left (left): goes on."));
  const TopicSeen seen = left_.Look(At(13));
  EXPECT_EQ(seen.arrivals.missed(), 9);
  EXPECT_EQ(seen.unwritten, 1);
  EXPECT_FALSE(seen.IsWhole());
}

// Transforms that stand still are sent once, and need not be there.
TEST_F(Followed, OfWhatIsOptionalNothingIsMissed) {
  FollowedTopic still{{"/tf_static", {}, {bags::MessageKind::kTransforms}},
                      [this](const std::string& text) { said_.push_back(text); }};
  still.TellTroubles(At(60));
  EXPECT_TRUE(still.Come(1, Meet(1, "tf2_msgs/msg/TFMessage", true, "/tf_static"), kS));
  EXPECT_TRUE(still.Come(2, Meet(2, "tf2_msgs/msg/TFMessage", true, "/tf_static"), kS));
  still.TellTroubles(At(90));
  still.End(1);
  still.End(2);
  EXPECT_THAT(said_, testing::IsEmpty());
}

}  // namespace
}  // namespace rigcal::recording
