#include "client/text/cause_list.h"

#include <gtest/gtest.h>

#include <sstream>

namespace rigcal::client {
namespace {

Document ParsedDocument(const std::string& text) {
  const auto document = Document::Parse(text, "test");
  EXPECT_TRUE(document);
  return document.value_or(Document());
}

const char* const kRevision = R"({
  "causes": [
    {"kind": "board_size", "why": "The squares of board panel are probably 92.70 mm, not 90.00 mm.",
     "what_to_do": "Measure one with a caliper and correct session.yaml.", "command": "rigcal push FOLDER", "edges": ["1", "2"]},
    {"kind": "board_unseen", "why": "rear sees board panel in none of 12 pictures.", "what_to_do": "Show it the board.",
     "command": "rigcal check FOLDER", "edges": ["3"]},
    {"kind": "not_measured", "why": "No session measured up.", "what_to_do": "Capture up.", "command": null, "edges": []}],
  "edges": [
    {"id": "9", "frame_a": "left", "frame_b": "top", "state": "good", "method": "lidar_camera", "diagnoses": []},
    {"id": "2", "frame_a": "right", "frame_b": "top", "state": "failed", "diagnoses": [{"code": "board_size_suspected", "what": "of right", "cure": "c"}]},
    {"id": "1", "frame_a": "front", "frame_b": "top", "state": "failed", "diagnoses": [{"code": "board_size_suspected", "what": "of front", "cure": "c"}]},
    {"id": "3", "frame_a": "left", "frame_b": "rear", "state": "failed", "diagnoses": [{"code": "too_few_captures", "what": "of rear", "cure": "c"}]},
    {"id": "4", "frame_a": "rear", "frame_b": "left", "state": "failed", "diagnoses": [{"code": "ambiguous_board", "what": "an older one", "cure": "c"}]},
    {"id": "5", "frame_a": "left", "frame_b": "up", "state": "failed", "diagnoses": [{"code": "no_agreement", "what": "of no cause", "cure": "c"}]},
    {"id": "6", "frame_a": "front", "frame_b": "top", "state": "failed", "diagnoses": [{"code": "superseded", "what": "a past one", "cure": "c"}]}]})";

TEST(PrintCauses, EachIsALineWithItsCommandBelow) {
  std::ostringstream out;
  PrintCauses(ParsedDocument(kRevision)["causes"], out);
  EXPECT_EQ(
      out.str(),
      "Causes, each with what to do\n"
      "  The squares of board panel are probably 92.70 mm, not 90.00 mm; explains 2 failed pairs. Measure one with "
      "a caliper and correct session.yaml. Then:\n"
      "    rigcal push FOLDER\n"
      "  rear sees board panel in none of 12 pictures; explains 1 failed pair. Show it the board. Then:\n"
      "    rigcal check FOLDER\n"
      "  No session measured up. Capture up.\n");
}

TEST(PrintCauses, OfARevisionOfBeforeAreNothing) {
  std::ostringstream out;
  PrintCauses(ParsedDocument(R"({"edges": []})")["causes"], out);
  EXPECT_EQ(out.str(), "");
}

TEST(PrintEdgesByCause, OnePairPerWordAndNoReasonTwice) {
  const Document revision = ParsedDocument(kRevision);
  std::ostringstream out;
  PrintEdgesByCause(revision["causes"], revision["edges"].Items(), out);
  const std::string text = out.str();
  EXPECT_NE(text.find("FAILED, 2 pairs: The squares of board panel are probably 92.70 mm, not 90.00 mm.\n"
                      "  front - top, right - top\n"
                      "FAILED, 1 pair: rear sees board panel in none of 12 pictures.\n"
                      "  left - rear\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("left - up: FAILED\n  of no cause. c."), std::string::npos) << text;
  EXPECT_NE(text.find("front - top: PAST\n  a past one. c.\n"), std::string::npos) << text;
  EXPECT_NE(text.find("lidar_camera"), std::string::npos) << "the good one: " << text;
  for (const char* alone : {"of front", "of right", "of rear", "an older one"})
    EXPECT_EQ(text.find(alone), std::string::npos) << text;
}

// A note on a good edge knows nothing of the cause, and may ask for the opposite.
TEST(PrintEdgesByCause, NotesHaveACureOnlyWhereNoCauseHasOne) {
  const Document edges = ParsedDocument(
      R"([{"frame_a": "left", "frame_b": "top", "state": "good", "method": "stereo",
           "diagnoses": [{"code": "any", "what": "the board was seen small", "cure": "Go nearer"}]}])");
  std::ostringstream alone, beside;
  PrintEdgesByCause(Document(), edges.Items(), alone);
  PrintEdgesByCause(ParsedDocument(kRevision)["causes"], edges.Items(), beside);
  EXPECT_NE(alone.str().find("left - top:\n  the board was seen small. Go nearer.\n"), std::string::npos)
      << alone.str();
  EXPECT_NE(beside.str().find("left - top:\n  the board was seen small.\n"), std::string::npos) << beside.str();
}

TEST(PrintEdgesByCause, WithoutCausesEachFailureStandsAlone) {
  std::ostringstream out;
  PrintEdgesByCause(Document(), ParsedDocument(kRevision)["edges"].Items(), out);
  for (const char* alone : {"of front", "of right", "of rear", "an older one", "of no cause"})
    EXPECT_NE(out.str().find(alone), std::string::npos) << out.str();
}

}  // namespace
}  // namespace rigcal::client
