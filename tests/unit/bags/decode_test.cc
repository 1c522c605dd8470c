// Bytes written down by hand from the CDR and ROS 1 descriptions.
#include <gmock/gmock.h>

#include <cmath>

#include "client/bags/messages/value.h"

namespace rigcal::bags {
namespace {

using ::testing::HasSubstr;

Topic TopicOf(const std::string& text, const std::string& encoding) {
  return {"/t", "a/A", encoding, encoding == "ros1" ? "ros1msg" : "ros2msg", text};
}
std::vector<std::byte> BytesOf(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

constexpr const char* kText = "uint8 a\nint32 b\nfloat64 c\nstring d\nuint16[] e\nbool[2] f\n";
// a = 5, b = -2, c = 1.5, d = "hi", e = [1, 258], f = [true, false]
const auto kLittle = BytesOf({0,    1, 0, 0, 5, 0,   0,   0, 0xFE, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0xF8,
                              0x3F, 3, 0, 0, 0, 'h', 'i', 0, 0,    2,    0,    0,    0, 1, 0, 2, 1, 1, 0});
const auto kBig = BytesOf({0, 0, 0, 0, 5, 0,   0,   0, 0xFF, 0xFF, 0xFF, 0xFE, 0x3F, 0xF8, 0, 0, 0, 0, 0,
                           0, 0, 0, 0, 3, 'h', 'i', 0, 0,    0,    0,    0,    2,    0,    1, 1, 2, 1, 0});
const auto kRos1 = BytesOf(
    {5, 0xFE, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0xF8, 0x3F, 2, 0, 0, 0, 'h', 'i', 2, 0, 0, 0, 1, 0, 2, 1, 1, 0});

void ExpectAll(const Value& value) {
  EXPECT_EQ(value["a"].Integer(), 5);
  EXPECT_EQ(value["b"].Integer(), -2);
  EXPECT_EQ(value["c"].Real(), 1.5);
  EXPECT_EQ(value["d"].Text(), "hi");
  ASSERT_EQ(value["e"].count(), 2U);
  EXPECT_EQ(value["e"].RealAt(0), 1);
  EXPECT_EQ(value["e"].RealAt(1), 258);
  EXPECT_EQ(value["f"].RealAt(0), 1);
  EXPECT_EQ(value["f"].RealAt(1), 0);
  EXPECT_TRUE(value["g"].IsAbsent());
  EXPECT_EQ(value["g"]["h"].Real(7), 7);
}

TEST(Decode, BothByteOrdersAndRos1AreTheSame) {
  const Topic cdr = TopicOf(kText, "cdr"), ros1 = TopicOf(kText, "ros1");
  const auto definition = DefinitionOf(cdr).value(), definition1 = DefinitionOf(ros1).value();
  const auto little = Decode(cdr, *definition, kLittle), big = Decode(cdr, *definition, kBig),
             old = Decode(ros1, *definition1, kRos1);
  ASSERT_TRUE(little && big && old);
  ExpectAll(*little);
  ExpectAll(*big);
  ExpectAll(*old);
  EXPECT_TRUE(little->SameAs(*big));
  EXPECT_TRUE(little->SameAs(*old));
}

TEST(Decode, AnEmptyMessageIsAByteOfCdr) {
  const Topic topic = TopicOf("Nothing n\nuint8 x\n===\nMSG: a/Nothing\n", "cdr");
  const auto definition = DefinitionOf(topic).value();
  const auto bytes = BytesOf({0, 1, 0, 0, 0, 9});
  EXPECT_EQ(Decode(topic, *definition, bytes)->operator[]("x").Integer(), 9);
}

TEST(Decode, ASequenceWithoutElementsIsNotAligned) {
  const Topic topic = TopicOf("float64[] none\nuint8 x\n", "cdr");
  const auto definition = DefinitionOf(topic).value();
  const auto bytes = BytesOf({0, 1, 0, 0, 0, 0, 0, 0, 9});
  EXPECT_EQ(Decode(topic, *definition, bytes)->operator[]("x").Integer(), 9);
}

TEST(Decode, EveryCutIsRefusedAndNoneAborts) {
  const Topic topic = TopicOf(kText, "cdr");
  const auto definition = DefinitionOf(topic).value();
  for (std::size_t size = 0; size < kLittle.size(); ++size) {
    const auto value = Decode(topic, *definition, Bytes(kLittle).first(size));
    ASSERT_FALSE(value) << size;
    EXPECT_THAT(value.error().what, HasSubstr("\"/t\""));
  }
}

TEST(Decode, ClaimsAreNotBelieved) {
  const auto huge = BytesOf({0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3});
  for (const char* text :
       {"float64[] x\n", "string x\n", "string[] x\n", "Inner[] x\n===\nMSG: a/Inner\n", "uint8[] x\n"}) {
    const Topic topic = TopicOf(text, "cdr");
    EXPECT_FALSE(Decode(topic, *DefinitionOf(topic).value(), huge)) << text;
  }
  const auto ros1 = BytesOf({0xFF, 0xFF, 0xFF, 0xFF});  // empty messages take no byte there
  const Topic topic = TopicOf("Inner[] x\n===\nMSG: a/Inner\n", "ros1");
  const auto value = Decode(topic, *DefinitionOf(topic).value(), ros1);
  ASSERT_FALSE(value);
  EXPECT_THAT(value.error().what, HasSubstr("more than 1000000 values"));
}

TEST(Decode, OtherEncodingsAreRefusedByName) {
  const Topic topic = TopicOf("uint8 x\n", "cdr");
  const auto definition = DefinitionOf(topic).value();
  EXPECT_THAT(Decode(topic, *definition, BytesOf({0, 3, 0, 0, 1})).error().what, HasSubstr("PL_CDR"));
  EXPECT_THAT(Decode(topic, *definition, BytesOf({0, 7, 0, 0, 1})).error().what, HasSubstr("XCDR2"));
  EXPECT_THAT(Decode(topic, *definition, BytesOf({0, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10})).error().what,
              HasSubstr("more than its definition"));
  EXPECT_THAT(Decode({"/t", "a/A", "json", "", ""}, *definition, BytesOf({'{', '}'})).error().what,
              HasSubstr("\"json\""));
}

}  // namespace
}  // namespace rigcal::bags
