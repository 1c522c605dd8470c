// Bags that others recorded: dialects, containers, damage.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "client/bags/messages/cloud.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "client/bags/open_bag.h"
#include "tests/unit/recordings.h"

namespace rigcal::bags {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::filesystem::path Bag_(const std::string& name) { return Recording("bags/formats/" + name); }

struct Told {
  std::int64_t messages = 0;
  std::map<std::string, std::int64_t> of_topic;
  std::vector<Error> damage;
};
Told ReadAll(const std::filesystem::path& path) {
  Told told;
  const auto bag = OpenBag(path);
  if (!bag) return {0, {}, {bag.error()}};
  for (Message message; (*bag)->Next(message); ++told.messages) ++told.of_topic[message.topic->name];
  told.damage = (*bag)->Unread().All();
  return told;
}

#define SKIP_WITHOUT_BAGS() RIGCAL_SKIP_WITHOUT_RECORDING("bags/formats")

// A message with all that its value points into.
struct Kept {
  std::shared_ptr<const Topic> topic;
  std::shared_ptr<const Definition> definition;
  std::vector<std::byte> bytes;
  Value value;
};
std::map<std::string, std::vector<std::unique_ptr<Kept>>> DecodeAll(const std::filesystem::path& path) {
  std::map<std::string, std::vector<std::unique_ptr<Kept>>> all;
  const auto bag = OpenBag(path).value();
  for (Message message; bag->Next(message);) {
    auto kept = std::make_unique<Kept>();
    kept->topic = message.topic;
    kept->bytes.assign(message.bytes.begin(), message.bytes.end());
    const auto definition = DefinitionOf(*message.topic);
    // The oldest bags hold no definitions, and of what no session is made of none is built in.
    EXPECT_TRUE(definition || message.topic->type == "sensor_msgs/NavSatFix") << definition.error().what;
    if (!definition) continue;
    kept->definition = *definition;
    auto value = Decode(*kept->topic, *kept->definition, kept->bytes);
    EXPECT_TRUE(value) << value.error().what;
    if (value) kept->value = *std::move(value);
    all[message.topic->name].push_back(std::move(kept));
  }
  EXPECT_TRUE(bag->Unread().empty());
  return all;
}

// Both were written by one program, one after the other: headers differ by the nanoseconds in which it did.
std::size_t WordsThatDiffer(const std::vector<std::byte>& x, const std::vector<std::byte>& y) {
  std::size_t words = 0;
  for (std::size_t at = 0; at + 4 <= std::min(x.size(), y.size()); at += 4)
    words += std::equal(x.begin() + static_cast<std::ptrdiff_t>(at), x.begin() + static_cast<std::ptrdiff_t>(at) + 4,
                        y.begin() + static_cast<std::ptrdiff_t>(at))
                 ? 0
                 : 1;
  return words;
}

TEST(RecordedBags, NinetyFourTypesDecodeEqualInBothForms) {
  SKIP_WITHOUT_BAGS();
  const auto mcap = DecodeAll(Bag_("alltypes/alltypes.mcap")), database = DecodeAll(Bag_("alltypes/alltypes.db3"));
  ASSERT_THAT(mcap, SizeIs(94));
  ASSERT_THAT(database, SizeIs(94));
  std::size_t same = 0;
  for (const auto& [topic, messages] : mcap) {
    const auto& others = database.at(topic);
    ASSERT_EQ(messages.size(), 2U) << topic;
    ASSERT_EQ(others.size(), 2U) << topic;
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_EQ(messages[i]->bytes.size(), others[i]->bytes.size()) << topic;
      const std::size_t differ = WordsThatDiffer(messages[i]->bytes, others[i]->bytes);
      EXPECT_LE(differ, 6U) << topic;  // a path has a header and five poses with one each
      EXPECT_EQ(messages[i]->value.SameAs(others[i]->value), differ == 0) << topic;
      same += differ == 0 ? 1 : 0;
    }
  }
  EXPECT_GE(same, 100U);
}

TEST(RecordedBags, TheOldestDatabaseHasARealPicture) {
  SKIP_WITHOUT_BAGS();
  const auto all = DecodeAll(Bag_("legacy_crystal_image_imu/sample.db3"));
  const auto image = ReadImage(all.at("/image").at(0)->value);
  ASSERT_TRUE(image) << image.error().what;
  EXPECT_EQ(image->width_px, 640);
  EXPECT_EQ(image->height_px, 480);
  EXPECT_EQ(image->data.size(), 921'600U);
  EXPECT_TRUE(ReadCompressedImage(all.at("/image/compressed").at(0)->value));
}

TEST(RecordedBags, Ros1OfEveryPackingHoldsTheSame) {
  SKIP_WITHOUT_BAGS();
  const Told plain = ReadAll(Bag_("ros1_fixtures/example.bag"));
  EXPECT_EQ(plain.messages, 8647);
  EXPECT_THAT(plain.damage, SizeIs(0));
  for (const char* packed : {"ros1_fixtures/example-bz2.bag", "ros1_fixtures/example-lz4.bag"}) {
    const Told told = ReadAll(Bag_(packed));
    EXPECT_EQ(told.of_topic, plain.of_topic) << packed;
    EXPECT_THAT(told.damage, SizeIs(0)) << packed;
  }
  EXPECT_EQ(ReadAll(Bag_("ros1_fixtures/no-messages.bag")).messages, 0);
  EXPECT_GT(ReadAll(Bag_("ros1_fixtures/rosbag2_bag_v2_multiple_connections.bag")).messages, 0);
  EXPECT_GT(ReadAll(Bag_("ouster_packets/512x10_raw.bag")).messages, 40);
}

TEST(RecordedBags, AllOfARealRobotDecodes) {
  RIGCAL_SKIP_WITHOUT_RECORDING("bags/husky_odom_imu");
  const auto all = DecodeAll(Recording("bags/husky_odom_imu/test1.bag"));
  ASSERT_THAT(all.at("/husky_velocity_controller/odom"), SizeIs(3952));
  for (const auto& message : all.at("/husky_velocity_controller/odom")) ASSERT_TRUE(ReadPose(message->value));
  for (const auto& [topic, messages] : all)
    for (const auto& message : messages) {
      if (KindOf(message->topic->type) != MessageKind::kImu) continue;
      ASSERT_TRUE(ReadImu(message->value)) << topic;
    }
}

TEST(RecordedBags, SplitBagsAreReadInTheirOrder) {
  SKIP_WITHOUT_BAGS();
  for (const char* form : {"mcap", "sqlite3"}) {
    const std::string folder = std::string("ros2_rosbag2/rosbag2_py/") + form;
    EXPECT_GT(ReadAll(Bag_(folder + "/reindex_test_bags/multiple_files")).messages, 0)
        << form;  // without metadata.yaml
    const Told told = ReadAll(Bag_(folder + "/wbag"));
    EXPECT_GT(told.messages, 0) << form;
    EXPECT_THAT(told.damage, SizeIs(0)) << form << ": " << (told.damage.empty() ? "" : told.damage[0].what);
  }
}

TEST(RecordedBags, EachDamagedOneIsOneSentenceAndGivesWhatItHas) {
  SKIP_WITHOUT_BAGS();
  const Told whole = ReadAll(Bag_("truncated/test_sample.mcap")),
             cut = ReadAll(Bag_("truncated/test_sample_truncated.mcap"));
  EXPECT_THAT(whole.damage, SizeIs(0));
  ASSERT_THAT(cut.damage, SizeIs(1));
  EXPECT_THAT(cut.damage[0].what, HasSubstr("test_sample_truncated.mcap"));
  EXPECT_GT(cut.messages, 0);
  EXPECT_LE(cut.messages, whole.messages);
  EXPECT_THAT(ReadAll(Bag_("ros1_fixtures/empty-file.bag")).damage, SizeIs(1));
  EXPECT_THAT(ReadAll(Bag_("ros2_rosbag2/rosbag2_tests/empty_dir")).damage, SizeIs(1));
  const Told empty = ReadAll(Bag_("ros2_rosbag2/ros2bag/empty_bag"));
  EXPECT_EQ(empty.messages, 0);
  EXPECT_THAT(empty.damage, SizeIs(0));
}

TEST(RecordedBags, AnEncodingThatOnlyTheMetadataClaimsIsTold) {
  SKIP_WITHOUT_BAGS();
  const Told told = ReadAll(Bag_("ros2_rosbag2/rosbag2_tests/sqlite3/wrong_rmw_test"));
  EXPECT_EQ(told.messages, 7);
  ASSERT_THAT(told.damage, SizeIs(1));
  EXPECT_THAT(told.damage[0].what, HasSubstr("wrong_format"));
}

TEST(RecordedBags, AnUnknownEncodingIsRefusedByName) {
  SKIP_WITHOUT_BAGS();
  const auto bag = OpenBag(Bag_("ros2_rosbag2/rosbag2_tests/mcap/wrong_rmw_test")).value();
  std::int64_t count = 0;
  for (Message message; bag->Next(message); ++count) {
    const auto value = Decode(*message.topic, *DefinitionOf(*message.topic).value(), message.bytes);
    ASSERT_FALSE(value);
    EXPECT_THAT(value.error().what, HasSubstr("\"wrong_format\""));
  }
  EXPECT_EQ(count, 7);
}

TEST(RecordedBags, MessagesOfEveryKindOfTypeDecode) {
  SKIP_WITHOUT_BAGS();
  for (const char* form : {"mcap", "sqlite3"})
    for (const auto& [topic, messages] :
         DecodeAll(Bag_(std::string("ros2_rosbag2/rosbag2_tests/") + form + "/cdr_test")))
      for (const auto& message : messages) EXPECT_FALSE(message->value.IsAbsent()) << topic;
}

}  // namespace
}  // namespace rigcal::bags
