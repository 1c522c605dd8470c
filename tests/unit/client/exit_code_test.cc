// What a verb ends with says what the robot's verdict is: 0 pass, 1 fail, 5 warn, 6 unknown or overdue.
#include <gtest/gtest.h>

#include <map>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

struct Case {
  const char* level;
  bool overdue = false;
  int code = 0;
  const char* rule = "Drive as you like";  // as the server says it
};
constexpr Case kCases[] = {{"pass", false, 0},    {"pass", true, 6},    {"warn", false, 5},
                           {"warn", true, 6},     {"fail", false, 1},   {"fail", true, 1},
                           {"unknown", false, 6}, {"unknown", true, 6}, {"of a newer server", false, 6}};

// The edge of kEdgeFile, as the server tells it: its id is what the client makes of it.
std::string EdgeRow(const std::string& id) {
  return R"({"id":")" + id + R"(","frame_a":"a","frame_b":"b","state":"good"})";
}

// Every document that tells a verdict of robot r1.
FakeServer::AnswerTo Telling(const Case& told, const std::string& edge_id = "e1") {
  const std::string verdict = std::string(R"("verdict":{"level":")") + told.level + R"(","why":"so it is"})";
  const std::string validity =
      std::string(R"("calibrated_at":"2026-11-22T08:00:00Z","valid_until":"2027-02-20T08:00:00Z","overdue":)") +
      (told.overdue ? "true" : "false") + R"(,"drive":{"rule":")" + told.rule + R"(","until":null})" +
      R"(,"calculating":false,"usable":{"revision":4,"created_at":"2026-11-22T09:00:00Z",)"
      R"("calibrated_at":"2026-03-12T08:00:00Z","valid_until":"2026-06-10T08:00:00Z"})";
  return [=](const std::string& verb, const std::string&) -> Result<std::string> {
    if (verb == "session") return R"({"session":{"jobs_waiting":0,"jobs_total":1},"edges":[)" + EdgeRow(edge_id) + "]}";
    if (verb == "status" || verb == "robots")
      return R"({"robots":[{"robot":"r1","revision":5,)" + verdict + "," + validity + "}]}";
    if (verb == "lookup") return R"({"robot":"r1","revision":5,)" + verdict + "," + validity + "}";
    return R"({"robot":"r1","revision":5,"published":true,"age_ns":60000000000,)" + validity + R"(,"document":{)" +
           verdict + R"(,"edges":[)" + EdgeRow(edge_id) + "]}}";
  };
}

TEST(ExitCode, OfEveryVerbThatTellsTheVerdictOfARobot) {
  SessionFolder folder;
  folder.WriteSession("r1", 1, 100);
  for (const Case& told : kCases) {
    FakeServer server("r1", Telling(told));
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"show", "r1"},
                                               {"show", "r1", "--revision", "5"},
                                               {"lookup", "r1", "a", "b"},
                                               {"status", "r1"},
                                               {"push", folder.path().string()}})
      for (const bool as_json : {false, true}) {
        std::vector<std::string> line = words;
        if (as_json) line.push_back("--json");
        const Ran ran = Rigcal(line);
        EXPECT_EQ(ran.code, told.code) << words.front() << " of " << told.level << "\n" << ran.out << ran.err;
      }
    EXPECT_EQ(Rigcal({"robots"}).code, 0) << "lists many";
    EXPECT_EQ(Rigcal({"status"}).code, told.code) << "of all";
  }
}

TEST(ExitCode, OfPushedEdges) {
  SessionFolder folder;
  folder.Write(
      "edges.json",
      R"({"format":1,"edges":[{"frame_a":"a","frame_b":"b","T_a_b":{"p_m":[0,1,0],"q_xyzw":[0,0,0,1]},"covariance":[)"
      R"([1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]}]})");
  const std::string file = (folder.path() / "edges.json").string();
  const auto edges = formats::ReadEdgeFile(
      [&] {
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        return text.str();
      }(),
      RobotId("r1"));
  ASSERT_TRUE(edges);
  for (const Case& told : kCases) {
    FakeServer server("r1", Telling(told, edges->front().id.str()));
    EXPECT_EQ(Rigcal({"push-edges", file, "--robot", "r1"}).code, told.code) << told.level;
    EXPECT_EQ(Rigcal({"push-edges", file, "--robot", "r1", "--no-wait"}).code, 0);
  }
}

TEST(ExitCode, OfAPushWithoutAResultIsUnknown) {
  SessionFolder folder;
  folder.WriteSession("r1", 1, 100);
  FakeServer server("r1", Always(R"({"session":{"jobs_waiting":0,"jobs_total":0},"edges":[]})"));
  const Ran ran = Rigcal({"push", folder.path().string()});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_NE(ran.out.find("there is no result"), std::string::npos) << ran.out;
  EXPECT_EQ(Rigcal({"push", folder.path().string(), "--no-wait"}).code, 0);
}

TEST(ExitCode, OfAComparisonWhoseSigmasAreNotKnownIsUnknown) {
  FakeServer server("r1", Always(R"({"revision":2,"document":{"reference":"a","sensors":[)"
                                 R"({"id":"a","T_ref_sensor":{"p_m":[0,0,0],"q_xyzw":[0,0,0,1]}},)"
                                 R"({"id":"b","T_ref_sensor":{"p_m":[1,0,0],"q_xyzw":[0,0,0,1]},"sigma_m":null}]}})"));
  EXPECT_EQ(Rigcal({"compare", "r1", "--with", "1"}).code, 0);
  EXPECT_EQ(Rigcal({"compare", "r1", "--with", "1", "--sigmas-max", "3"}).code, 6);
}

TEST(ExitCode, OfAComparisonOfHalfOfTheSensorsIsUnknown) {
  FakeServer server("r1", [](const std::string&, const std::string& json) -> Result<std::string> {
    const bool old = json.find("\"revision\":1") != std::string::npos;
    const std::string pose =
        R"("T_ref_sensor":{"p_m":[1,0,0],"q_xyzw":[0,0,0,1]},"sigma_m":[1,1,1],"sigma_rad":[1,1,1]})";
    return R"({"revision":)" + std::string(old ? "1" : "2") + R"(,"document":{"reference":"a","sensors":[{"id":"a",)" +
           pose + R"(,{"id":"b",)" + pose + R"(,{"id":")" + (old ? "old_top" : "new_top") + R"(",)" + pose + "]}}";
  });
  const Ran ran = Rigcal({"compare", "r1", "--with", "1"});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_NE(ran.out.find("not compared: new_top has no pose in revision 1; old_top has no pose in revision 2.\n"),
            std::string::npos)
      << ran.out;
  EXPECT_EQ(Rigcal({"compare", "r1", "--with", "1", "--sigmas-max", "3"}).code, 6);
}

TEST(ExitCode, OfStatusIsThatOfTheWorstRobot) {
  const auto row = [](const char* level, bool overdue = false) {
    return std::string(R"({"robot":"r1","overdue":)") + (overdue ? "true" : "false") + R"(,"verdict":{"level":")" +
           level + R"("}})";
  };
  const auto code = [](const std::string& rows) {
    FakeServer server("r1", Always(R"({"robots":[)" + rows + "]}"));
    return Rigcal({"status"}).code;
  };
  EXPECT_EQ(code(""), 0);
  EXPECT_EQ(code(row("pass") + "," + row("pass")), 0);
  EXPECT_EQ(code(row("pass") + "," + row("pass", true)), 6);
  EXPECT_EQ(code(row("warn") + "," + row("unknown") + "," + row("pass")), 6);
  EXPECT_EQ(code(row("unknown") + "," + row("fail") + "," + row("warn")), 1);
}

// By what the drive rule says, not by the verdict.
TEST(ExitCode, OfWhatIsNotInUseIsUnknown) {
  const auto row = [](const char* kind) {
    return std::string(R"({"robot":"r1","revision":5,"drive":{"kind":")") + kind +
           R"(","rule":"so"},"overdue":false,"verdict":{"level":"pass"},"document":{"verdict":{"level":"pass"}}})";
  };
  for (const auto& [kind, code] : std::map<const char*, int>{{"ok", 0},
                                                             {"ok_with_action", 5},
                                                             {"do_not_drive", 1},
                                                             {"not_applied", 6},
                                                             {"to_approve", 6},
                                                             {"not_verified", 6}}) {
    FakeServer server("r1", [text = row(kind)](const std::string& verb, const std::string&) -> Result<std::string> {
      return verb == "status" ? R"({"robots":[)" + text + "]}" : text;
    });
    EXPECT_EQ(Rigcal({"show", "r1"}).code, code) << kind;
    EXPECT_EQ(Rigcal({"lookup", "r1", "a", "b"}).code, code) << kind;
    EXPECT_EQ(Rigcal({"status", "r1"}).code, code) << kind;
  }
  FakeServer server("r1",
                    Always(R"({"robots":[)" + row("to_approve") + "," + row("to_approve") + "," + row("ok") + "]}"));
  const std::string status = Rigcal({"status"}).out;
  EXPECT_EQ(status.find("3 robots: 2 to be approved, 1 OK to drive\n"), 0U) << status;
}

TEST(Drive, TheRuleComesBeforeTheVerdict) {
  const Case told{"fail", false, 1, "Do not drive"};
  FakeServer server("r1", Telling(told));
  const std::string shown = Rigcal({"show", "r1"}).out;
  EXPECT_EQ(shown.find("r1, revision 5, calibrated 22 Nov 2026, solved 1 min ago\nDo not drive.\nverdict  fail"), 0U)
      << shown;
  EXPECT_EQ(Rigcal({"status", "r1"}).out.find("Do not drive.\n"), 0U);
  const std::string all = Rigcal({"status"}).out;
  EXPECT_EQ(all.find("1 robot: 1 do not drive\n"), 0U) << all;
  EXPECT_NE(all.find("Do not drive. fail: so it is."), std::string::npos) << all;
  EXPECT_NE(Rigcal({"robots"}).out.find("Do not drive."), std::string::npos);
  SessionFolder folder;
  folder.WriteSession("r1", 1, 100);
  const std::string pushed = Rigcal({"push", folder.path().string()}).out;
  EXPECT_LT(pushed.find("\nDo not drive.\nr1, revision 5\n"), pushed.find("verdict  fail")) << pushed;
}

TEST(Drive, EachLimitStandsBesideItsSigma) {
  FakeServer server(
      "r1",
      Always(R"({"robot":"r1","revision":1,"document":{"verdict":{"level":"pass"},"reference":"a","sensors":[)"
             R"({"id":"b","known":true,"tolerance_m":0.005,"tolerance_rad":0.005,"sigma_m":[0.0004,0.0002,0.0001],)"
             R"("sigma_rad":[0.001,0.001,0.001],"T_ref_sensor":{"p_m":[1,0,0],"q_xyzw":[0,0,0,1]}}]}})"));
  const std::string shown = Rigcal({"show", "r1"}).out;
  EXPECT_NE(shown.find("0.400 0.200 0.100 (limit 5)"), std::string::npos) << shown;
  EXPECT_NE(shown.find("(limit 0.286)"), std::string::npos) << shown;
}

TEST(Validity, OverdueIsSaidFirst) {
  const std::string overdue = "Not verified: do not rely on it, overdue since 20 Feb 2027; capture again.";
  FakeServer server(
      "r1", Telling({"pass", true, 6, "Not verified: do not rely on it, overdue since 20 Feb 2027; capture again"}));
  const std::string shown = Rigcal({"show", "r1"}).out;
  EXPECT_EQ(shown.find("r1, revision 5, calibrated 22 Nov 2026, solved 1 min ago\n" + overdue + "\nverdict  pass"), 0U)
      << shown;
  EXPECT_NE(Rigcal({"robots"}).out.find("overdue, pass"), std::string::npos);
  EXPECT_NE(Rigcal({"status"}).out.find("1 robot: 1 not verified"), std::string::npos);
  EXPECT_NE(Rigcal({"lookup", "r1", "a", "b"}).out.find(overdue + "\nverdict"), std::string::npos);
}

TEST(Validity, OfAFailThatItIsOverdueIsSaidToo) {
  FakeServer server("r1", Telling({"fail", true, 1, "Do not drive"}));
  const std::string shown = Rigcal({"show", "r1"}).out;
  EXPECT_NE(shown.find("Overdue since 20 Feb 2027. Calibrate the robot again before it is relied on.\nverdict  fail"),
            std::string::npos)
      << shown;
  EXPECT_NE(shown.find("Robots that listen still have revision 4, measured 12 Mar 2026: do not rely on it, either, "
                       "until this is cleared up."),
            std::string::npos)
      << shown;
}

TEST(Validity, NothingToFallBackToAndANewerOneOnItsWay) {
  FakeServer server(
      "r1", Always(R"({"revision":1,"usable":null,"calculating":true,"document":{"verdict":{"level":"fail"}}})"));
  const std::string shown = Rigcal({"show", "r1"}).out;
  EXPECT_NE(shown.find("There is no earlier calibration to fall back to."), std::string::npos) << shown;
  EXPECT_NE(shown.find("A newer revision is being calculated."), std::string::npos) << shown;
}

}  // namespace
}  // namespace rigcal::client
