// Whole verbs against a server in memory: what is printed, what is asked, how it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <sstream>
#include <thread>

#include "client/text/document.h"
#include "server/base/stamp.h"
#include "server/base/version.h"
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

std::string Lookup(const std::string& level) {
  return R"({"T_a_b":{"p_m":[0.08318,-0.00092,0.00012],"q_xyzw":[0,0,0.7071067811865476,0.7071067811865476]},"covariance":[)"
         R"([1e-06,0,0,0,0,0],[0,4e-06,0,0,0,0],[0,0,9e-06,0,0,0],[0,0,0,1e-08,0,0],[0,0,0,0,4e-08,0],[0,0,0,0,0,9e-08]],)"
         R"("frame_a":"left","frame_b":"right","revision":3,"robot":"r","sigma_m":[0.001,0.002,0.003],"sigma_rad":[0.0001,0.0002,0.0003],)"
         R"("verdict":{"level":")" +
         level + R"(","what_to_do":"Nothing","why":"all agree"},"new_field":[1]})";
}

TEST(Verbs, LookupPrintsPoseSigmaAndCovariance) {
  std::string asked_verb, asked_json;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked_verb = verb;
    asked_json = json;
    return Lookup("pass");
  });
  const Ran ran = Rigcal({"lookup", "r", "left", "right"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked_verb, "lookup");
  EXPECT_EQ(asked_json, R"({"robot":"r","a":"left","b":"right"})");
  EXPECT_NE(ran.out.find("T_left_right"), std::string::npos);
  EXPECT_NE(ran.out.find("p mm       83.180 -0.920 0.120"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("rpy deg    0.0000 0.0000 90.0000"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("sigma mm   1.0000 2.0000 3.0000"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("sigma deg  0.00573 0.01146 0.01719"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("9.0000e-08\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("verdict  pass: all agree. Nothing."), std::string::npos) << ran.out;
}

TEST(Verbs, JsonIsTheServersDocumentVerbatim) {
  FakeServer server("r", Always(Lookup("pass")));
  const Ran ran = Rigcal({"lookup", "r", "left", "right", "--json"});
  EXPECT_EQ(ran.out, Lookup("pass") + "\n");
  EXPECT_EQ(ran.err, "");
}

TEST(Verbs, CompareAsksForBothRevisionsAndJudgesBySigmas) {
  FakeServer server("r", [](const std::string&, const std::string& json) -> Result<std::string> {
    const bool old = json.find("\"revision\":1") != std::string::npos;
    return R"({"revision":)" + std::string(old ? "1" : "2") +
           R"(,"document":{"reference":"a","sensors":[{"id":"a","T_ref_sensor":{"p_m":[0,0,0],"q_xyzw":[0,0,0,1]}},)"
           R"({"id":"b","T_ref_sensor":{"p_m":[)" +
           (old ? "1" : "1.002") +
           R"(,0,0],"q_xyzw":[0,0,0,1]},"sigma_m":[0.001,0.001,0.001],"sigma_rad":[0.1,0.1,0.1]}]}})";
  });
  const Ran ran = Rigcal({"compare", "r", "--with", "1"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("r, revision 2, against revision 1, in a"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("2.000"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("2.0 sigma"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("  1.000  "), std::string::npos) << ran.out;  // sigma of the least certain axis, not their sum
  EXPECT_EQ(Rigcal({"compare", "r", "--with", "1", "--sigmas-max", "1.9"}).code, 1);
  EXPECT_EQ(Rigcal({"compare", "r", "--with", "1", "--sigmas-max", "2.1"}).code, 0);
  EXPECT_EQ(Rigcal({"compare", "r"}).code, 2);
  EXPECT_EQ(Rigcal({"compare", "r", "--poses", "/does/not/exist"}).code, 4);
  const auto json = Document::Parse(Rigcal({"compare", "r", "--with", "1", "--json"}).out, "compare");
  ASSERT_TRUE(json);
  EXPECT_NEAR(*(*json)["sensors"][0]["e"][0].Number(), 0.002, 1e-12);
}

TEST(Verbs, AnErrorIsASentenceAndExitCodeFour) {
  FakeServer server("r", [](const std::string&, const std::string&) -> Result<std::string> {
    return Fail(ErrorCode::kNotFound, "robot 'x' is not known", "`rigcal robots` lists those that are");
  });
  for (const char* verb : {"show", "edges", "status", "report"}) {
    const Ran ran = Rigcal({verb, "x"});
    EXPECT_EQ(ran.code, 4) << verb;
    EXPECT_EQ(ran.out, "") << verb;
    EXPECT_EQ(ran.err, "rigcal: robot 'x' is not known. `rigcal robots` lists those that are.\n") << verb;
  }
}

TEST(Verbs, DueListsTheOverdueAndExitsOneIfAnyIs) {
  std::string asked;
  bool overdue = true;
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return std::string(R"({"max_age_ns":2592000000000000,"now":"2026-01-31T12:00:00Z","robots":[)") +
           R"({"robot":"fresh","calibrated_at":"2026-01-30T12:00:00Z","age_ns":86400000000000,"overdue":false,"verdict":{"level":"pass"}},)" +
           R"({"robot":"old-one","calibrated_at":null,"age_ns":null,"overdue":)" + (overdue ? "true" : "false") +
           R"(,"verdict":{"level":"unknown"}}]})";
  });
  Ran ran = Rigcal({"due", "--max-age", "30d"});
  EXPECT_EQ(asked, R"({"max_age_ns":2592000000000000})");
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.out.find("old-one"), std::string::npos);
  EXPECT_EQ(ran.out.find("fresh"), std::string::npos);
  overdue = false;
  EXPECT_EQ(Rigcal({"due"}).code, 0);
  EXPECT_EQ(asked, "{}") << "as the policies say";
  EXPECT_EQ(Rigcal({"due", "--max-age", "soon"}).code, 2);
}

TEST(Verbs, EveryListTakesAnEmptyDocumentAndForeignTypes) {
  for (const std::string& text :
       {std::string("{}"),
        std::string(
            R"({"robots":[{"robot":7,"verdict":[]}],"sessions":[[]],"edges":[null,{"T_a_b":3}],"document":"x"})")}) {
    FakeServer server("r", Always(text));
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"robots"},
                                                                                       {"sessions"},
                                                                                       {"sessions", "r"},
                                                                                       {"edges", "r"},
                                                                                       {"show", "r"},
                                                                                       {"history", "r"},
                                                                                       {"lookup", "r", "a", "b"},
                                                                                       {"status"},
                                                                                       {"due"}})
      EXPECT_EQ(
          Rigcal(words).code,
          words.front() == "show" || words.front() == "lookup" || (words.front() == "status" && text != "{}") ? 6 : 0)
          << words.front() << " " << text;
  }
}

TEST(Verbs, RobotsAreListedInParts) {
  std::string asked;
  const std::string row = R"({"robot":"r2","verdict":{"level":"pass"}})";
  std::string next = R"("r2")", rows = row;
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return R"({"robots":[)" + rows + R"(],"next":)" + next + "}";
  });
  const Ran part = Rigcal({"robots", "--limit", "1", "--after", "r1"});
  EXPECT_EQ(part.code, 0) << part.err;
  EXPECT_EQ(asked, R"({"limit":1,"after":"r1"})");
  EXPECT_NE(part.out.find("More: rigcal robots --limit 1 --after r2\n"), std::string::npos) << part.out;
  next = "null";
  EXPECT_EQ(Rigcal({"robots", "--limit", "1"}).out.find("More:"), std::string::npos);
  EXPECT_EQ(asked, R"({"limit":1})");
  rows.clear();
  EXPECT_EQ(Rigcal({"robots", "--after", "r2"}).out, "No robot comes after r2.\n");
  EXPECT_EQ(asked, R"({"after":"r2"})");
  EXPECT_EQ(Rigcal({"robots"}).out, "No robot is known yet. Send a session with `rigcal push DIR`.\n");
  EXPECT_EQ(asked, "{}");
  EXPECT_EQ(Rigcal({"robots", "--limit", "0"}).code, 2);
}

TEST(Verbs, RobotsHaveColumnsForTheNamesThatAreKnown) {
  std::string names;
  FakeServer server("r", [&](const std::string&, const std::string&) -> Result<std::string> {
    return R"({"robots":[{"robot":"r1","verdict":{"level":"pass"},"due":{"at":"2026-05-01T12:00:00Z"})" + names +
           R"(},{"robot":"r2","verdict":{"level":"pass"},"due":null,"rig_model":null,"site":null,"operator":null}]})";
  });
  const Ran none = Rigcal({"robots"});
  EXPECT_NE(none.out.find("1 May 2026"), std::string::npos) << none.out;
  for (const char* title : {"MODEL", "SITE", "OPERATOR"})
    EXPECT_EQ(none.out.find(title), std::string::npos) << none.out;
  names = R"(,"rig_model":"mars-mapper","site":null,"operator":"Ada")";
  const Ran some = Rigcal({"robots"});
  for (const char* text : {"MODEL", "mars-mapper", "OPERATOR", "Ada"})
    EXPECT_NE(some.out.find(text), std::string::npos) << some.out;
  EXPECT_EQ(some.out.find("SITE"), std::string::npos) << some.out;
}

TEST(Verbs, WatchPrintsEventsAndEndsAfterItsCount) {
  FakeServer server("r");
  std::atomic<bool> ended{false};
  Ran ran;
  std::thread watcher([&] {
    ran = Rigcal({"watch", "r", "--count", "2"});
    ended = true;
  });
  // An event before the watcher knows our writer is not heard, so they are sent until it ends.
  while (!ended)
    if (server.HasWatcher())
      server.SendEvent("revision",
                       R"({"robot":"r","revision":4,"verdict":{"level":"warn","why":"one edge is far off"}})");
  watcher.join();
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("revision  revision 4, warn: one edge is far off."), std::string::npos) << ran.out;
  EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 2);
}

TEST(Verbs, WatchTellsOfTheGraphWhenMoreSensorsAreKnown) {
  FakeServer server("r");
  std::atomic<bool> ended{false};
  Ran ran;
  std::thread watcher([&] {
    ran = Rigcal({"watch", "r", "--count", "3"});
    ended = true;
  });
  while (!ended)
    if (server.HasWatcher()) {
      server.SendEvent("graph_update", R"({"robot":"r","edges":7,"sensors":5,"sensors_known":3})");
      server.SendEvent("session_closed", R"({"session":"0123456789abcdef0","payloads":71,"jobs_total":14})");
    }
  watcher.join();
  EXPECT_EQ(ran.code, 0);
  const std::size_t told = ran.out.find("3 of 5 sensors known, 7 edges");
  ASSERT_NE(told, std::string::npos) << ran.out;
  EXPECT_EQ(ran.out.find("sensors known", told + 20), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("session 0123456789abcdef came whole: 71 files, 14 pairs"), std::string::npos) << ran.out;
}

TEST(Verbs, DoctorFindsTheServer) {
  FakeServer server("r", [](const std::string& verb, const std::string&) -> Result<std::string> {
    if (verb == "status") return R"({"open_batches":[]})";
    EXPECT_EQ(verb, "health");
    return R"({"state":"ok","version":")" + std::string(Version()) + R"(","protocol":)" +
           std::to_string(kWireProtocol) + R"(,"schema":1,"uptime_ns":1,"now":")" + ToIso(SystemClock().Now()) +
           R"(","disk_free_bytes":90000000000,"problem":null})";
  });
  const Ran ran = Rigcal({"doctor", "--json"});
  const auto document = Document::Parse(ran.out, "doctor");
  ASSERT_TRUE(document) << ran.out << ran.err;
  std::map<std::string, std::string> levels;
  for (const Document& check : (*document)["checks"].Items()) levels[check["name"].Text()] = check["level"].Text();
  for (const char* name : {"dds", "discovery", "round trip", "versions", "clock", "disk of server"})
    EXPECT_EQ(levels[name], "ok") << name << " " << ran.out;
}

// What a server with a finished calibration of this session answers.
FakeServer::AnswerTo CalibratedServer(std::atomic<int>& session_questions) {
  return [&session_questions](const std::string& verb, const std::string& json) -> Result<std::string> {
    const std::string edge =
        R"({"id":"e1","frame_a":"left","frame_b":"right","state":"good","method":"stereo","session":null,"T_a_b":{"p_m":[0.08318,0,0],"q_xyzw":[0,0,0,1]},)"
        R"("sigma_m":[0.0001,0.0002,0.0003],"sigma_rad":[0.001,0.002,0.003],"diagnoses":[],"residual":null})";
    if (verb == "session") {
      const bool is_done = ++session_questions >= 2;
      return std::string(R"({"session":{"jobs_waiting":)") + (is_done ? "0" : "1") + R"(,"jobs_total":1},"edges":[)" +
             (is_done ? edge : "") + "]}";
    }
    if (verb == "status") return R"({"http_address":"http://127.0.0.1:8420","robots":[{"robot":"r1","revision":1}]})";
    if (verb == "known_robot" || verb == "known_files")
      return Fail(ErrorCode::kInvalidInput, "the verb is not known", "So says an older server.");
    EXPECT_EQ(verb, "show");
    EXPECT_EQ(json, R"({"robot":"r1","revision":1})");
    return R"({"robot":"r1","revision":1,"age_ns":1,"digest":"d","document":{"verdict":{"level":"pass","why":"all agree"},"edges":[)" +
           edge +
           R"(],"e_global":{"before":{"total":0.5,"translation_m2":0.4,"rotation_rad2":0.1},"after":{"total":0.05,"translation_m2":0.04,"rotation_rad2":0.01}}}})";
  };
}

TEST(Verbs, PushPrintsTheEdgesTheVerdictAndTheReport) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  std::atomic<int> session_questions{0};
  FakeServer server("r1", CalibratedServer(session_questions));
  const Ran ran = Rigcal({"push", folder.path().string()});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("left - right  stereo  good  sigma 0.100 0.200 0.300 mm"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("r1, revision 1"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("E_global  before 0.5"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("report  http://127.0.0.1:8420/robots/r1/revisions/1/"), std::string::npos) << ran.out;
  EXPECT_NE(ran.err.find("is stored: 4 files"), std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find('\x1b'), std::string::npos);
}

TEST(Verbs, PushWaitsForTheReport) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  std::atomic<int> session_questions{0};
  std::promise<void> shown, returned;
  const auto answer = [&, usual = CalibratedServer(session_questions)](const std::string& verb,
                                                                       const std::string& json) -> Result<std::string> {
    if (verb != "show") return usual(verb, json);
    shown.set_value();
    std::string text = *usual(verb, json);
    return text.insert(1, R"("published":false,)");
  };
  FakeServer server("r1", answer);
  auto returned_early = std::async(std::launch::async, [&] {
    shown.get_future().wait();
    const bool is_early = returned.get_future().wait_for(std::chrono::milliseconds(300)) == std::future_status::ready;
    server.SendEvent("published", R"({"robot":"r1","revision":1})");
    return is_early;
  });
  EXPECT_EQ(Rigcal({"push", folder.path().string()}).code, 0);
  returned.set_value();
  EXPECT_FALSE(returned_early.get());
}

TEST(Verbs, PushSaysWhichOfItsSensorsAreRetired) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  std::atomic<int> session_questions{0};
  FakeServer server("r1", [usual = CalibratedServer(session_questions)](const std::string& verb,
                                                                        const std::string& json) {
    auto answer = usual(verb, json);
    if (verb == "session")
      answer->insert(
          1, R"("retired_sensors":[{"sensor":"left","at":"2026-02-01T12:00:00Z","who":"Ada","reason":"taken off"}],)");
    return answer;
  });
  const Ran ran = Rigcal({"push", folder.path().string()});
  EXPECT_NE(
      ran.err.find(
          "left was retired on 2026-02-01 by Ada: taken off. `rigcal restore left --robot r1` brings it back. Until "
          "then what was sent of it does not count.\n"),
      std::string::npos)
      << ran.err;
}

TEST(Verbs, PushJsonIsOneDocument) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  std::atomic<int> session_questions{0};
  FakeServer server("r1", CalibratedServer(session_questions));
  const Ran ran = Rigcal({"push", folder.path().string(), "--json"});
  const auto document = Document::Parse(ran.out, "push");
  ASSERT_TRUE(document) << ran.out;
  EXPECT_EQ((*document)["items"].Integer(), 4);
  EXPECT_EQ((*document)["total"].Integer(), 4000);
  EXPECT_EQ((*document)["show"]["revision"].Integer(), 1);
  EXPECT_EQ((*document)["report"].Text(), "http://127.0.0.1:8420/robots/r1/revisions/1/");
}

TEST(Verbs, PushWithoutWaitingAsksOnlyWhetherRobotAndFilesAreKnown) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  std::set<std::string> asked;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked.insert(verb + json);
    return R"({"known":true,"robot":"r1","slip_of":[]})";
  });
  EXPECT_EQ(Rigcal({"push", folder.path().string(), "--no-wait", "--new-robot"}).code, 0);
  EXPECT_EQ(server.requests_seen, 0);
  EXPECT_EQ(Rigcal({"push", folder.path().string(), "--no-wait"}).code, 0);
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_EQ(*asked.rbegin(), R"(known_robot{"robot":"r1"})");
  EXPECT_EQ(asked.begin()->rfind(R"(known_files{"digests":")", 0), 0u) << *asked.begin();
}

TEST(Verbs, PushOfAnotherRobotsFilesSendsNothingUnlessItIsMeant) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  FakeServer server("r1", [&](const std::string& verb, const std::string&) -> Result<std::string> {
    if (verb == "known_robot") return R"({"known":true,"robot":"r1","slip_of":[]})";
    return R"({"asked":4,"files":3,"robot":"r2","session":"0123456789abcdef0123","captured_at":"2026-08-01T10:00:00Z"})";
  });
  const Ran ran = Rigcal({"push", folder.path().string(), "--no-wait"});
  EXPECT_EQ(ran.code, 4);
  EXPECT_NE(ran.err.find("3 of 4 files looked at are the same as in the session of robot r2 of 1 Aug 2026 "
                         "(0123456789abcdef), not of 'r1'. Correct `robot:` in session.yaml"),
            std::string::npos)
      << ran.err;
  EXPECT_EQ(server.SubjectsSeen(), std::set<std::string>{}) << "nothing was sent";
  EXPECT_EQ(Rigcal({"push", folder.path().string(), "--no-wait", "--new-robot"}).code, 0);
}

TEST(Verbs, APushForAMisspeltRobotSendsNothing) {
  SessionFolder folder, edges;
  folder.WriteSession("maper-01", 2, 1000);
  edges.Write("edges.json", R"({"format":1,"edges":[{"frame_a":"a","frame_b":"b","T_a_b":{"p_m":[0,1,0],)"
                            R"("q_xyzw":[0,0,0,1]},"information":[[1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],)"
                            R"([0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]}]})");
  FakeServer server("maper-01", Always(R"({"known":false,"robot":"maper-01","slip_of":["mapper-01","maper-1"]})"));
  const std::string file = (edges.path() / "edges.json").string();
  const std::vector<std::string> push_edges = {"push-edges", file, "--robot", "maper-01", "--no-wait"};
  for (const auto& words : {push_edges, {"push", folder.path().string(), "--no-wait"}}) {
    const Ran ran = Rigcal(words);
    EXPECT_EQ(ran.code, 4) << words.front();
    EXPECT_EQ(ran.err,
              "rigcal: robot 'maper-01' is new, and mapper-01 is known: push with --new-robot if it is another robot. "
              "Else correct the name; nothing was sent.\n");
    EXPECT_TRUE(server.SubjectsSeen().empty()) << words.front();
  }
  EXPECT_EQ(Rigcal({"push", folder.path().string(), "--no-wait", "--new-robot"}).code, 0);
  EXPECT_EQ(server.SubjectsSeen().size(), 1U);
}

TEST(Verbs, PushEdgesTakesJson) {
  SessionFolder folder;
  folder.Write(
      "edges.json",
      R"({"format":1,"edges":[{"frame_a":"a","frame_b":"b","T_a_b":{"p_m":[0,1,0],"q_xyzw":[0,0,0,1]},"covariance":[)"
      R"([1,0,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]}]})");
  FakeServer server("r1");
  const Ran ran =
      Rigcal({"push-edges", (folder.path() / "edges.json").string(), "--robot", "r1", "--no-wait", "--json"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  const auto document = Document::Parse(ran.out, "push-edges");
  ASSERT_TRUE(document);
  EXPECT_EQ((*document)["items"].Integer(), 1);
  EXPECT_EQ(server.Subject((*document)["id"].Text()).payloads.size(), 1U);
}

}  // namespace
}  // namespace rigcal::client
