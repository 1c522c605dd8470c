#include "client/bags/messages/definition.h"

#include <gmock/gmock.h>

namespace rigcal::bags {
namespace {

using ::testing::HasSubstr;

Topic TopicOf(const std::string& type, const std::string& encoding, const std::string& text,
              const std::string& message_encoding = "cdr") {
  return {"/topic", type, message_encoding, encoding, text};
}

// "uint8 small; float64[3] three; pkg/Inner[<=2] inner": one line per field, types of types below.
std::string Drawn(const MessageType& type, int depth = 0) {
  std::string text;
  for (const FieldType& field : type.fields) {
    text += std::string(static_cast<std::size_t>(depth), ' ') + field.name + " " +
            std::to_string(SizeOf(field.primitive)) + " " + field.message;
    if (field.arity == Arity::kFixed) text += "[" + std::to_string(field.count) + "]";
    if (field.arity == Arity::kSequence) text += "[<=" + std::to_string(field.count_max) + "]";
    text += "\n" + (field.type != nullptr ? Drawn(*field.type, depth + 1) : "");
  }
  return text;
}

constexpr const char* kMsg =
    "# a comment\n"
    "uint8 LIMIT=3   # a constant\n"
    "string NAME = a text\n"
    "std_msgs/Header header\n"
    "uint8 small 7\n"
    "float64[3] three [1.0, 2.0, 3.0]\n"
    "int64[] any\n"
    "string<=5[<=4] words\n"
    "Inner[<=2] inner\n"
    "builtin_interfaces/Duration[2] spans\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n"
    "================================================================================\n"
    "MSG: pkg/Inner\n"
    "bool yes\n"
    "float32 x\n";

constexpr const char* kIdl =
    "================================================================================\n"
    "IDL: pkg/msg/Outer\n"
    "// generated\n"
    "#include \"pkg/msg/Inner.idl\"\n"
    "module pkg { module msg {\n"
    "  typedef double double__3[3];\n"
    "  typedef builtin_interfaces::msg::Duration Duration__2[2];\n"
    "  module Outer_Constants { const uint8 LIMIT = 3; const string NAME = \"a } text\"; };\n"
    "  @verbatim (language=\"comment\", text=\"said (of it)\" \"\\n\")\n"
    "  struct Outer {\n"
    "    std_msgs::msg::Header header;\n"
    "    @default (value=7)\n"
    "    uint8 small;\n"
    "    double__3 three;\n"
    "    sequence<int64> any; /* as many */\n"
    "    sequence<string<5>, 4> words;\n"
    "    sequence<pkg::msg::Inner, 2> inner;\n"
    "    Duration__2 spans;\n"
    "  };\n"
    "}; };\n"
    "================================================================================\n"
    "IDL: pkg/msg/Inner\n"
    "module pkg { module msg { struct Inner { boolean yes; float x; }; }; };\n";

TEST(Definition, MsgTextAndIdlAreTheSameTree) {
  const auto msg = DefinitionOf(TopicOf("pkg/msg/Outer", "ros2msg", kMsg));
  const auto idl = DefinitionOf(TopicOf("pkg/msg/Outer", "ros2idl", kIdl));
  ASSERT_TRUE(msg) << msg.error().what;
  ASSERT_TRUE(idl) << idl.error().what;
  EXPECT_EQ(Drawn(*(*msg)->root),
            "header 0 std_msgs/Header\n stamp 0 builtin_interfaces/Time\n  sec 4 \n  nanosec 4 \n frame_id 0 \n"
            "small 1 \nthree 8 [3]\nany 8 [<=0]\nwords 0 [<=4]\ninner 0 pkg/Inner[<=2]\n yes 1 \n x 4 \n"
            "spans 0 builtin_interfaces/Duration[2]\n sec 4 \n nanosec 4 \n");
  EXPECT_EQ(Drawn(*(*idl)->root), Drawn(*(*msg)->root));
}

TEST(Definition, NamesOfTypesInEverySpelling) {
  EXPECT_EQ(PlainTypeName("sensor_msgs/msg/Image"), "sensor_msgs/Image");
  EXPECT_EQ(PlainTypeName("sensor_msgs/Image"), "sensor_msgs/Image");
  EXPECT_EQ(PlainTypeName("sensor_msgs::msg::dds_::Image_"), "sensor_msgs/Image");
  EXPECT_EQ(PlainTypeName(""), "");
}

TEST(Definition, WhatABagLeavesOutIsKnownOfSensors) {
  const auto image = DefinitionOf(TopicOf("sensor_msgs/Image", "", ""));
  ASSERT_TRUE(image) << image.error().what;
  EXPECT_EQ((*image)->root->fields.size(), 7U);
  const auto header = DefinitionOf(TopicOf("std_msgs/Header", "", "", "ros1"));
  ASSERT_TRUE(header);
  EXPECT_EQ((*header)->root->fields[0].name, "seq");
}

TEST(Definition, WhatCannotBeReadIsNamed) {
  const std::pair<Topic, const char*> cases[] = {
      {TopicOf("my_msgs/Odd", "", ""), "\"my_msgs/Odd\" is missing"},
      {TopicOf("a/A", "ros2msg", "a/B b\n===\nMSG: a/B\na/A a\n"), "contains itself"},
      {TopicOf("a/A", "protobuf", "x"), "written as \"protobuf\""},
      {TopicOf("a/A", "ros2msg", "float64[x] b\n"), "no number of elements"},
      {TopicOf("a/A", "ros2msg", "float64\n"), "no name"},
      {TopicOf("a/A", "ros2idl", "module a { union U { }; };"), "\"union\""},
      {TopicOf("a/A", "ros2idl", "module a { struct A { double x"), "in place of \";\""},
      {TopicOf("a/A", "ros2idl", "/* no end"), "comment without an end"},
  };
  for (const auto& [topic, words] : cases) {
    const auto definition = DefinitionOf(topic);
    ASSERT_FALSE(definition) << topic.schema;
    EXPECT_THAT(definition.error().what, HasSubstr(words));
    EXPECT_THAT(definition.error().what, HasSubstr("/topic"));
  }
}

TEST(Definition, DeepNestingEnds) {
  std::string text = "a/T0 x\n";
  for (int i = 0; i < 100; ++i) text += "===\nMSG: a/T" + std::to_string(i) + "\na/T" + std::to_string(i + 1) + " x\n";
  EXPECT_FALSE(DefinitionOf(TopicOf("a/A", "ros2msg", text)));
}

}  // namespace
}  // namespace rigcal::bags
