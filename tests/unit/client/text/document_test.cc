#include "client/text/document.h"

#include <gtest/gtest.h>

namespace rigcal::client {
namespace {

TEST(Document, ReadsWhatIsThereAndNothingElse) {
  const auto document = Document::Parse(R"({"a": [1, 2.5, "x"], "b": {"c": true}, "n": null})", "test");
  ASSERT_TRUE(document);
  EXPECT_EQ((*document)["a"].size(), 3U);
  EXPECT_EQ((*document)["a"][0].Integer(), 1);
  EXPECT_EQ((*document)["a"][1].Number(), 2.5);
  EXPECT_EQ((*document)["a"][1].Integer(), std::nullopt);
  EXPECT_EQ((*document)["a"][2].Text(), "x");
  EXPECT_TRUE((*document)["b"]["c"].Flag());
  EXPECT_TRUE((*document)["n"].IsNull());
}

TEST(Document, WhatIsAbsentOrOfAnotherTypeIsNull) {
  const auto document = Document::Parse(R"({"a": [1], "t": "text"})", "test");
  ASSERT_TRUE(document);
  EXPECT_TRUE((*document)["x"]["y"][7]["z"].IsNull());
  EXPECT_TRUE((*document)["a"][1].IsNull());
  EXPECT_TRUE((*document)["t"]["u"].IsNull());
  EXPECT_EQ((*document)["t"].Number(), std::nullopt);
  EXPECT_EQ((*document)["a"].Text("-"), "-");
  EXPECT_TRUE((*document)["t"].Items().empty());
  EXPECT_TRUE(Document().IsNull());
}

TEST(Document, AChildOutlivesItsParent) {
  Document child;
  {
    const auto document = Document::Parse(R"({"a": {"b": [{"c": "deep"}]}})", "test");
    ASSERT_TRUE(document);
    child = (*document)["a"]["b"].Items().front();
  }
  EXPECT_EQ(child["c"].Text(), "deep");
}

TEST(Document, WhatIsNoJsonIsRefusedByName) {
  const auto document = Document::Parse("{\"a\": ", "the server's answer");
  ASSERT_FALSE(document);
  EXPECT_NE(document.error().what.find("the server's answer"), std::string::npos);
}

TEST(Document, WhatIsNestedDeepIsRefused) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  const std::string deepest = std::string(kDocumentDepthMax, '[') + "7" + std::string(kDocumentDepthMax, ']');
  EXPECT_EQ(Document::Parse(deepest, "test").value().Dump(), deepest);
  const auto beyond = Document::Parse(nested(kDocumentDepthMax + 1), "the server's answer");
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().what.find("the server's answer is nested deeper than 64 levels"), std::string::npos);
  std::string objects;
  for (int i = 0; i < 300'000; ++i) objects += "{\"a\":";
  EXPECT_FALSE(Document::Parse(objects + "1" + std::string(300'000, '}'), "test"));
  EXPECT_FALSE(Document::Parse(nested(300'000), "test"));
  EXPECT_FALSE(Document::Parse("{\"a\":" + nested(300'000) + "}", "test"));
}

TEST(JsonObject, EscapesWhatPeopleType) {
  const std::string text = JsonObject({{"robot", "a\"b\n"}, {"n", std::int64_t{-3}}, Field::Raw("list", "[1]")});
  EXPECT_EQ(text, R"({"robot":"a\"b\n","n":-3,"list":[1]})");
  ASSERT_TRUE(Document::Parse(text, "test"));
  EXPECT_NO_THROW(static_cast<void>(JsonObject({{"robot", "\xff\xfe"}})));
  EXPECT_EQ(JsonObject({}), "{}");
}

}  // namespace
}  // namespace rigcal::client
