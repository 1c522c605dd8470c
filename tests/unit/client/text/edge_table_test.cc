#include "client/text/edge_table.h"

#include <gtest/gtest.h>

#include <sstream>

namespace rigcal::client {
namespace {

Document ParsedEdges(const std::string& text) {
  const auto document = Document::Parse(text, "test");
  EXPECT_TRUE(document);
  return document.value_or(Document());
}

const char* const kEdges = R"([
  {"id": "1", "frame_a": "left", "frame_b": "right", "state": "good", "method": "stereo", "diagnoses": [],
   "T_a_b": {"p_m": [0.08318, 0, 0], "q_xyzw": [0, 0, 0, 1]}, "sigma_m": [0.0001, 0.0002, 0.0003],
   "sigma_rad": [0.001, null, 0.003], "residual": {"e": [0.003, 0.004, 0, 0, 0, 0.0174532925199], "weighted": 1.5, "in_solution": true}},
  {"id": "2", "frame_a": "left", "frame_b": "top", "state": "failed", "method": "stereo", "T_a_b": null, "sigma_m": null,
   "sigma_rad": null, "residual": null, "diagnoses": [{"code": "too_few_captures", "what": "only 2 captures show the board to both", "cure": "Record at least 8"}]}
])";

TEST(PrintEdges, GoodOnesInTheTableFailedOnesWithReasonAndCure) {
  std::ostringstream out;
  PrintEdges(ParsedEdges(kEdges).Items(), out);
  const std::string text = out.str();
  EXPECT_NE(text.find("83.18 0.00 0.00"), std::string::npos) << text;
  EXPECT_NE(text.find("0.100 0.200 0.300"), std::string::npos) << text;
  EXPECT_NE(text.find("0.0573 - 0.1719"), std::string::npos) << text;
  EXPECT_NE(text.find("5.000"), std::string::npos) << text;   // |e| = 5 mm
  EXPECT_NE(text.find("1.0000"), std::string::npos) << text;  // and 1 degree
  EXPECT_NE(text.find("left - top: FAILED\n  only 2 captures show the board to both. Record at least 8."),
            std::string::npos)
      << text;
}

TEST(PrintEdges, PastOnesByReasonAndNotAsFailed) {
  const std::string past = R"("state": "failed", "method": "stereo",
    "diagnoses": [{"code": "remounted", "what": "sensor top was remounted", "cure": "Measure it anew"}]})";
  std::ostringstream out;
  PrintEdges(ParsedEdges(R"([{"frame_a": "left", "frame_b": "top", )" + past +
                         R"(, {"frame_a": "top", "frame_b": "rear", )" + past + "]")
                 .Items(),
             out);
  EXPECT_EQ(out.str(), "left - top, top - rear: PAST\n  sensor top was remounted\n");
}

TEST(PrintEdges, WhatWasTakenOutIsToldWithTheCommandThatBringsItBack) {
  for (const char* code : {"retired", "sensor_retired", "superseded"}) {
    const std::string past =
        R"([{"frame_a": "left", "frame_b": "top", "state": "failed", "method": "given",
      "diagnoses": [{"code": ")" +
        std::string(code) +
        R"(", "what": "retired by Ada: mistyped", "cure": "`rigcal restore 12ab` brings it back."}]}])";
    std::ostringstream out;
    PrintEdges(ParsedEdges(past).Items(), out);
    EXPECT_EQ(out.str(), "left - top: PAST\n  retired by Ada: mistyped. `rigcal restore 12ab` brings it back.\n")
        << code;
  }
}

TEST(PrintEdges, NothingForNoEdges) {
  std::ostringstream out;
  PrintEdges({}, out);
  EXPECT_EQ(out.str(), "");
}

TEST(PrintEdges, APolishedPoseIsMarkedAndSaysBy) {
  const auto text_with = [](const std::string& polished) {
    const std::string edges =
        R"([{"frame_a": "top", "frame_b": "rear", "state": "good", "method": "lidar_lidar", "T_a_b": null,
             "figures": {"polished_ratio": )" +
        polished + R"(}, "diagnoses": [{"code": "any", "what": "moved by 1.2 mm", "cure": "Leave it away"}]}])";
    std::ostringstream out;
    PrintEdges(ParsedEdges(edges).Items(), out);
    return out.str() + EdgeLine(ParsedEdges(edges).Items()[0]);
  };
  EXPECT_EQ(text_with("0.0").find("gicp"), std::string::npos);
  const std::string text = text_with("1.0");
  EXPECT_NE(text.find("rear  lidar_lidar+gicp"), std::string::npos) << text;
  EXPECT_NE(text.find("top - rear  lidar_lidar+gicp  good"), std::string::npos) << text;
  EXPECT_NE(text.find("top - rear:\n  moved by 1.2 mm. Leave it away."), std::string::npos) << text;
}

TEST(EdgeLine, OneLine) {
  const auto edges = ParsedEdges(kEdges).Items();
  EXPECT_EQ(EdgeLine(edges[0]), "left - right  stereo  good  sigma 0.100 0.200 0.300 mm, 0.0573 - 0.1719 deg");
  EXPECT_EQ(EdgeLine(edges[1]), "left - top  stereo  failed  only 2 captures show the board to both.")
      << "what to do is the verdict's";
  EXPECT_EQ(EdgeLine(Document()), "? - ?  -  ?");
}

TEST(PrintGlobalError, BeforeAndAfterWithPartsAndAWordWhereNothingChecks) {
  const std::string parts = R"("e_global": {"before": {"total": 0.5, "translation_m2": 0.4, "rotation_rad2": 0.1},
                                            "after": {"total": 0.05, "translation_m2": 0.04, "rotation_rad2": 0.01}})";
  const std::string line = "E_global  before 0.5 (0.4 m^2 + 0.1 rad^2)  after 0.05 (0.04 m^2 + 0.01 rad^2)\n";
  std::ostringstream with_loop, without;
  PrintGlobalError(ParsedEdges("{\"dof\": 6, " + parts + "}"), with_loop);
  EXPECT_EQ(with_loop.str(), line);
  PrintGlobalError(ParsedEdges("{\"dof\": 0, " + parts + "}"), without);
  EXPECT_EQ(without.str(), line + "          no loop of edges: each fits by construction, so this checks nothing\n");
}

}  // namespace
}  // namespace rigcal::client
