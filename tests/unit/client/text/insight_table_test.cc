#include "client/text/insight_table.h"

#include <gtest/gtest.h>

#include <sstream>

namespace rigcal::client {
namespace {

Document Parsed(const std::string& text) {
  const auto document = Document::Parse(text, "test");
  EXPECT_TRUE(document);
  return document.value_or(Document());
}

std::string Influence(const std::string& text) {
  std::ostringstream out;
  PrintInfluence(Parsed(text), out);
  return out.str();
}

std::string Loops(const std::string& text) {
  std::ostringstream out;
  PrintLoops(Parsed(text), out);
  return out.str();
}

TEST(PrintInfluence, TheMostInfluentialEdgeFirst) {
  const std::string text = Influence(R"({"influence": {"judged": true, "why_not": null}, "edges": [
    {"frame_a": "left", "frame_b": "top", "influence": {"checked": true, "sensor": "top", "move": [0.003, 0.004, 0, 0, 0.0174532925199, 0], "move_sigmas": 1.5}},
    {"frame_a": "left", "frame_b": "up", "influence": {"checked": false, "sensor": null, "move": null, "move_sigmas": null}},
    {"frame_a": "left", "frame_b": "right", "influence": {"checked": true, "sensor": "right", "move": [0, 0, 0.02, 0, 0, 0], "move_sigmas": 7.25}}]})");
  EXPECT_NE(
      text.find("left - right  right  20.000  0.0000       7.25\nleft - top    top     5.000  1.0000       1.50\n"),
      std::string::npos)
      << text;
  EXPECT_EQ(text.find("left - up"), std::string::npos) << text;
}

TEST(PrintInfluence, SaysWhatWasLeftOut) {
  EXPECT_EQ(
      Influence(R"({"influence": {"judged": false, "why_not": "Influence was left out: too large."}, "edges": []})"),
      "\nInfluence: what leaving out one edge changes\n  Influence was left out: too large.\n");
  EXPECT_EQ(Influence(R"({"edges": []})"), "");  // of before
}

TEST(PrintLoops, WorstFirstWithItsTest) {
  const std::string text =
      Loops(R"({"cycles": {"judged": true, "why_not": null, "examined": 3, "tested": 2, "failing": 1, "worst": [
    {"sensors": ["left", "top", "right"], "e": [0.003, 0.004, 0, 0, 0, 0.0174532925199], "tested": true, "t_squared": 90, "limit": 36.1, "fails": true},
    {"sensors": ["left", "top"], "e": [0, 0, 0, 0, 0, 0], "tested": true, "t_squared": 9.5, "limit": null, "fails": false},
    {"sensors": ["a", "b"], "e": [0, 0, 0, 0, 0, 0], "tested": false, "t_squared": 0, "limit": null, "fails": false}]}})");
  EXPECT_NE(text.find("Loops: 3 worked out, 2 tested, 1 does not close\n"), std::string::npos) << text;
  EXPECT_NE(text.find("left - top - right - left  5.000  1.0000             90.0 (36.1)  FAILS\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("9.5 (too few captures)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("no test\n"), std::string::npos) << text;
}

TEST(PrintLoops, LongLoopsAreCutAndNoneAreNamed) {
  EXPECT_NE(Loops(R"({"cycles": {"judged": true, "examined": 0, "worst": []}})").find("none: nothing checks the edges"),
            std::string::npos);
  const std::string text = Loops(
      R"({"cycles": {"judged": true, "examined": 1, "tested": 0, "failing": 0, "worst": [{"sensors": ["1","2","3","4","5","6","7","8","9"]}]}})");
  EXPECT_NE(text.find("8 - ... (9 edges) - 1"), std::string::npos) << text;
  EXPECT_NE(text.find("0 tested, nothing says whether they close"), std::string::npos) << text;
  EXPECT_EQ(Loops("{}"), "");  // of before
}

}  // namespace
}  // namespace rigcal::client
