#include "server/formats/answers/parameters.h"

#include <gtest/gtest.h>

namespace rigcal::formats {
namespace {

TEST(Parameters, FlatObjectsOnly) {
  const auto good = Parameters::Read(R"({"robot":"r","revision":3,"flag":true})");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->Text("robot"), "r");
  EXPECT_EQ(good->IntegerOr("revision", 0), 3);
  EXPECT_EQ(good->IntegerOr("absent", 7), 7);
  EXPECT_FALSE(good->IntegerOr("robot", 0));
  EXPECT_TRUE(Parameters::Read(""));
  for (const char* bad : {"[]", "1", "{", R"({"a":{"b":1}})", R"({"a":[1]})", R"({"a":1.5})", R"({"a":null})"})
    EXPECT_FALSE(Parameters::Read(bad)) << bad;
  EXPECT_FALSE(Parameters::Read(std::string(100'000, '[')));
  EXPECT_NE(Parameters::Read(R"({"\u001b[2J":null})").error().what.find(R"("\x1b[2J")"), std::string::npos);
}

// Of an order over HTTP, whose thread has a stack of 1 MiB.
TEST(Parameters, OneMoreIsPutIntoFlatOnesOnly) {
  EXPECT_EQ(WithParameter(R"({"robot":"r","revision":3})", "who", "ada").value(),
            R"({"revision":3,"robot":"r","who":"ada"})");
  EXPECT_EQ(WithParameter("", "who", "ada").value(), R"({"who":"ada"})");
  EXPECT_EQ(WithParameter(R"({"who":"ada"})", "who", "ada").value(), R"({"who":"ada"})");
  EXPECT_EQ(WithParameter(R"({"who":"eve"})", "who", "ada").value(), R"({"who":"ada"})");
  for (const std::size_t depth : {std::size_t{1}, std::size_t{2}, std::size_t{10'000}, std::size_t{30'000}}) {
    const std::string nested = std::string(depth, '[') + std::string(depth, ']');
    for (const std::string& text : {nested, "{\"id\":" + nested + "}", "{\"who\":" + nested + "}"})
      EXPECT_FALSE(WithParameter(text, "who", "ada")) << depth;
  }
  EXPECT_FALSE(WithParameter(R"({"a":{"b":1}})", "who", "ada"));
}

TEST(Parameters, FlagsAreBooleansOrTheirWords) {
  const auto given = Parameters::Read(R"({"a":true,"b":false,"c":"1","d":"0","e":"yes"})").value();
  for (const char* name : {"a", "c"}) EXPECT_EQ(given.Flag(name), true) << name;
  for (const char* name : {"b", "d", "absent"}) EXPECT_EQ(given.Flag(name), false) << name;
  EXPECT_EQ(given.Flag("e").error().what, "the parameter \"e\" is neither true nor false");
}

TEST(Parameters, QueryStringsAreDecoded) {
  EXPECT_EQ(ParametersOfQuery("robot=a%2Db&x=1+2&&flag").value(), R"({"flag":"","robot":"a-b","x":"1 2"})");
  EXPECT_EQ(ParametersOfQuery("").value(), "{}");
  EXPECT_FALSE(ParametersOfQuery("a=%2"));
  EXPECT_FALSE(ParametersOfQuery("a=%zz"));
}

}  // namespace
}  // namespace rigcal::formats
