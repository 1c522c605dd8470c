#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/formats/json/nearest.h"

namespace rigcal::formats {
namespace {

using testing::HasSubstr;

std::string Written(double value) {
  JsonWriter out;
  out.Number(value);
  return out.Finish();
}

// The expected texts are what Python's json.dumps prints.
TEST(JsonWriter, PrintsNumbersAsPythonDoes) {
  const std::vector<std::pair<double, std::string>> cases = {
      {0.0, "0.0"},
      {-0.0, "0.0"},
      {1.0, "1.0"},
      {-2.5, "-2.5"},
      {0.1, "0.1"},
      {1.0 / 3.0, "0.3333333333333333"},
      {0.1 + 0.2, "0.30000000000000004"},
      {1e-4, "0.0001"},
      {0.00011, "0.00011"},
      {1e-5, "1e-05"},
      {1.5e-7, "1.5e-07"},
      {100000.0, "100000.0"},
      {1e15, "1000000000000000.0"},
      {1e16, "1e+16"},
      {1.25e+22, "1.25e+22"},
      {9007199254740993.0, "9007199254740992.0"},
      {5e-324, "5e-324"},
      {1.7976931348623157e308, "1.7976931348623157e+308"},
      {5.0e-324 * 3, "1.5e-323"},
      {9.5367431640625e-07, "9.5367431640625e-07"},
  };
  for (const auto& [value, text] : cases) EXPECT_EQ(Written(value), text);
}

TEST(JsonWriter, NeverPrintsWhatIsNotANumber) {
  EXPECT_EQ(Written(std::nan("")), "null");
  EXPECT_EQ(Written(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(Written(-std::numeric_limits<double>::infinity()), "null");
}

TEST(JsonWriter, RandomDoublesComeBackBitForBit) {
  std::mt19937_64 engine(7);
  for (int i = 0; i < 20'000; ++i) {
    const double value = std::bit_cast<double>(engine());
    if (!std::isfinite(value)) continue;
    auto document = JsonDocument::Parse(Written(value), {"number", "", 1000});
    ASSERT_TRUE(document) << Written(value);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(document->Root().Number()), std::bit_cast<std::uint64_t>(value));
  }
}

TEST(JsonWriter, SortsKeysAndEscapes) {
  const std::string text = WriteObject([](JsonWriter& out) {
    out.Text("b", "quote \" backslash \\ line\nend \x01 Å");
    out.Integer("a", -9223372036854775807);
    out.List("c", [&] {
      out.Flag(true);
      out.Null();
      out.Object([] {});
    });
  });
  EXPECT_EQ(
      text,
      "{\"a\":-9223372036854775807,\"b\":\"quote \\\" backslash \\\\ line\\nend \\u0001 Å\",\"c\":[true,null,{}]}");
}

TEST(JsonWriter, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(WriteObject([](JsonWriter& out) { out.Text("a", "x\xffy"); }), "{\"a\":\"x\xef\xbf\xbdy\"}");
}

struct BadDocument {
  std::string text;
  std::string what;
};

class HostileJson : public testing::TestWithParam<BadDocument> {};

// Reads {"list": [{"number", "integer", "flag", "text", "three"}]}.
Status ReadAll(const std::string& text) {
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, {"thing", "Mend it.", 20'000}));
  document.Root().AllowOnly({"list", "optional"});
  for (const JsonField& item : document.Root().At("list").Items(2)) {
    (void)item.At("number").Number();
    (void)item.At("integer").Integer(0, 10);
    (void)item.At("flag").Flag();
    (void)item.At("text").Text(5);
    double three[3];
    item.At("three").Numbers(three, 3);
    (void)item.At("members").Members(1);
  }
  return document.status();
}

constexpr const char* kGood =
    R"({"list": [{"number": 1, "integer": 2, "flag": true, "text": "abc", "three": [1, 2, 3], "members": {"m": 1}}]})";

std::string GoodWith(const std::string& from, const std::string& to) {
  std::string text = kGood;
  return text.replace(text.find(from), from.size(), to);
}

TEST_P(HostileJson, IsRefusedByPath) {
  const Status status = ReadAll(GetParam().text);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(status.error().what, GetParam().what);
  EXPECT_EQ(status.error().cure, "Mend it.");
}

INSTANTIATE_TEST_SUITE_P(
    Cases, HostileJson,
    testing::Values(
        BadDocument{"", "thing: line 1: not JSON, near the end"},
        BadDocument{"{\n\"list\": [}", "thing: line 2: not JSON, near \"\\\"list\\\": [}\""},
        BadDocument{"{} x", "thing: line 1: not JSON, near \"{} x\""},
        BadDocument{"[NaN]", "thing: line 1: not JSON, near \"[N\""},
        BadDocument{"{\"list\": [1e999]}", "thing: line 1: a number is too large, near \"1e999\""},
        BadDocument{"\"\xff\"", "thing: line 1: not JSON, near \"\\\"\\xff\""},
        BadDocument{std::string(33, '[') + std::string(33, ']'), "thing: nested deeper than 32 levels"},
        BadDocument{std::string(9'000, '['), "thing: nested deeper than 32 levels"},
        BadDocument{std::string(20'001, ' '), "thing: has 20001 bytes; the limit is 20000"},
        BadDocument{R"({"list": [], "list": []})", "thing: \"list\" stands twice in one object"},
        BadDocument{"[]", "thing: must be an object {...}"}, BadDocument{"{}", "thing: \"list\" is missing"},
        BadDocument{R"({"list": [], "lits": 1})", "thing: unknown field \"lits\"; did you mean \"list\"?"},
        BadDocument{R"({"list": [], "xyz": 1})", "thing: unknown field \"xyz\"; known here: list and optional"},
        BadDocument{R"({"list": {}})", "thing: list: must be a list [...]"},
        BadDocument{R"({"list": [{}, {}, {}]})", "thing: list: has 3 entries; the limit is 2"},
        BadDocument{R"({"list": [3]})", "thing: list[0]: must be an object {...}"},
        BadDocument{GoodWith("\"number\"", "\"n\""), "thing: list[0]: \"number\" is missing"},
        BadDocument{GoodWith("1,", "\"1\","), "thing: list[0].number: must be a number"},
        BadDocument{GoodWith("2,", "2.0,"), "thing: list[0].integer: must be an integer from 0 to 10"},
        BadDocument{GoodWith("2,", "11,"), "thing: list[0].integer: must be an integer from 0 to 10"},
        BadDocument{GoodWith("2,", "18446744073709551615,"), "thing: list[0].integer: must be an integer from 0 to 10"},
        BadDocument{GoodWith("true", "1"), "thing: list[0].flag: must be true or false"},
        BadDocument{GoodWith("\"abc\"", "null"), "thing: list[0].text: must be text"},
        BadDocument{GoodWith("abc", "abcdef"), "thing: list[0].text: has 6 bytes; the limit is 5"},
        BadDocument{GoodWith("[1, 2, 3]", "[1, 2]"), "thing: list[0].three: must be a list of 3 numbers"},
        BadDocument{GoodWith("[1, 2, 3]", "[1, 2, null]"), "thing: list[0].three[2]: must be a number"},
        BadDocument{GoodWith("{\"m\": 1}", "[]"), "thing: list[0].members: must be an object {...}"},
        BadDocument{GoodWith("\"m\": 1", "\"m\": 1, \"k\": 2"),
                    "thing: list[0].members: has 2 members; the limit is 1"}));

TEST(Json, TheGoodDocumentIsGood) { EXPECT_TRUE(ReadAll(kGood)); }

TEST(Nearest, FindsTheMisspeltName) {
  const std::vector<std::string_view> known = {"square_size_m", "square_size_sigma_m", "serial", "type"};
  EXPECT_EQ(Nearest("square_size", known), "square_size_m");
  EXPECT_EQ(Nearest("square_size_sgima_m", known), "square_size_sigma_m");
  EXPECT_EQ(Nearest("square", known), "square_size_m");
  EXPECT_EQ(Nearest("tpye", known), "type");
  EXPECT_EQ(Nearest("weather", known), "");
  EXPECT_EQ(Nearest(std::string(100'000, 'x'), known), "");
}

}  // namespace
}  // namespace rigcal::formats
