// Files that seem to be in millimetres: asked about on standard error, and a session with such a rig is refused.
#include <gtest/gtest.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kClosed = R"({"known":true,"slip_of":[],"session":{"jobs_waiting":0,"jobs_total":0},"edges":[]})";

// The session with the right camera drawn so far from the left one.
void WriteDrawnSession(const SessionFolder& folder, double apart_m) {
  folder.WriteSession("r1", 1, 100);
  folder.Write(
      "session.yaml",
      "format: 1\nrobot: r1\ncaptured_at: 2026-01-31T12:00:00Z\ntargets:\n  board: {type: checkerboard, "
      "inner_corners: [9, 6], square_size_m: 0.025}\nsensors:\n  left: {type: camera}\n  right: {type: camera, "
      "T_ref_nominal: {p_m: [" +
          std::to_string(apart_m) + ", 0, 0], q_xyzw: [0, 0, 0, 1]}}\n");
}

TEST(UnitDoubts, OfNominalPosesAreToldAndBeyondAnyRobotRefused) {
  FakeServer server("r1", Always(kClosed));
  SessionFolder folder;
  for (const double apart_m : {0.08, 60.0, 210.0}) {
    WriteDrawnSession(folder, apart_m);
    const Ran ran = Rigcal({"push", folder.path().string(), "--no-wait"});
    const std::string question = " m between left and right: are these millimetres?";
    EXPECT_EQ(ran.code, apart_m > 100.0 ? 4 : 0) << ran.err;
    EXPECT_EQ(ran.err.find("60" + question + " Positions are taken in metres.\n") != std::string::npos, apart_m == 60.0)
        << ran.err;
    EXPECT_EQ(ran.err.find("rigcal: session.yaml line 8: T_ref_nominal: 210" + question) != std::string::npos,
              apart_m == 210.0)
        << ran.err;
  }
}

TEST(UnitDoubts, OfEdgesAreTold) {
  FakeServer server("r1", Always(kClosed));
  SessionFolder folder;
  folder.Write("edges.json", R"({"format":1,"edges":[{"frame_a":"front_left","frame_b":"top","T_a_b":{"p_m":[0,210,0],)"
                             R"("q_xyzw":[0,0,0,1]},"information":[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],)"
                             R"([0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]}]})");
  const std::string file = (folder.path() / "edges.json").string();
  const Ran ran = Rigcal({"push-edges", file, "--robot", "r1", "--no-wait"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(
      ran.err.rfind(
          file + ": 210 m between front_left and top: are these millimetres? Positions are taken in metres.\n", 0),
      0U)
      << ran.err;
}

TEST(UnitDoubts, OfPosesToCompareWithAreTold) {
  FakeServer server("r1", Always(R"({"revision":2,"document":{"reference":"a","sensors":[)"
                                 R"({"id":"a","T_ref_sensor":{"p_m":[0,0,0],"q_xyzw":[0,0,0,1]}},)"
                                 R"({"id":"b","T_ref_sensor":{"p_m":[0.21,0,0],"q_xyzw":[0,0,0,1]}}]}})"));
  SessionFolder folder;
  folder.Write("poses.yaml",
               "sensors:\n  a: {T_ref_sensor: {p_m: [0, 0, 0], q_xyzw: [0, 0, 0, 1]}}\n"
               "  b: {T_ref_sensor: {p_m: [210, 0, 0], q_xyzw: [0, 0, 0, 1]}}\n");
  const std::string file = (folder.path() / "poses.yaml").string();
  const Ran ran = Rigcal({"compare", "r1", "--poses", file});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.err, file + ": 210 m between a and b: are these millimetres? Positions are taken in metres.\n");
  EXPECT_NE(ran.out.find("209790"), std::string::npos) << ran.out;
}

}  // namespace
}  // namespace rigcal::client
