// What counts, and what was taken out: what `restore` and `retire` ask and print, and where lists and `show` say it.
#include <gtest/gtest.h>

#include <atomic>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kRestoredRow =
    R"({"session":"aaaaaaaaaaaaaaaaaaaa","robot":"r1","state":"closed","superseded_by":null,"supersedes":["bbbbbbbbbbbbbbbbbbbb"],)"
    R"("standing":{"number":8,"how":"restored","at":"2026-02-01T12:00:00Z","who":"Ada","reason":"wrong squares"}})";
constexpr const char* kSupersededRow =
    R"({"session":"bbbbbbbbbbbbbbbbbbbb","robot":"r1","state":"closed","supersedes":[],"superseded_by":{"session":"aaaaaaaaaaaaaaaaaaaa",)"
    R"("captured_at":"2026-01-31T00:00:00Z","operator":"Eve","standing":{"number":8,"how":"restored","at":"2026-02-01T12:00:00Z",)"
    R"("who":"Ada","reason":"wrong squares"}}})";

TEST(Standing, SessionsSayWhichSupersedesWhich) {
  FakeServer server("r1", Always(std::string(R"({"sessions":[)") + kRestoredRow + "," + kSupersededRow + "]}"));
  const Ran ran = Rigcal({"sessions"});
  EXPECT_NE(ran.out.find("superseded"), std::string::npos) << ran.out;
  EXPECT_NE(
      ran.out.find("Session bbbbbbbbbbbbbbbb does not count: session aaaaaaaaaaaaaaaa of the same pictures (captured "
                   "2026-01-31T00:00:00Z, by Eve), restored by Ada on 2026-02-01T12:00:00Z (wrong squares), "
                   "supersedes it. `rigcal restore bbbbbbbbbbbbbbbb` takes that back.\n"),
      std::string::npos)
      << ran.out;
}

// The newest revision may be one from before the order: it is asked for until it counts it.
TEST(Standing, AnOrderWaitsForTheRevisionThatCountsIt) {
  std::atomic<bool> is_counted = false;
  std::string asked;
  const auto answer = [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    if (verb == "restore") {
      asked = json;
      return std::string(R"({"revision_follows":true,"session":)") + kRestoredRow + "}";
    }
    if (verb == "status")
      return std::string(R"({"robots":[{"robot":"r1","revision":)") + (is_counted ? "2" : "1") + "}]}";
    const bool is_old = json.find(R"("revision":1})") != std::string::npos;
    is_counted = true;
    return std::string(R"({"robot":"r1","revision":)") + (is_old ? "1" : "2") + R"(,"standing":)" +
           (is_old ? "7" : "8") + R"(,"document":{"verdict":{"level":")" + (is_old ? "pass" : "fail") +
           R"("},"edges":[]}})";
  };
  FakeServer server("r1", answer);
  const Ran ran = Rigcal({"restore", "aaaaaaaa", "--by", "Ada", "--reason", "wrong squares", "--robot", "r1"});
  EXPECT_EQ(ran.code, 1) << ran.err;
  EXPECT_EQ(asked, R"({"thing":"aaaaaaaa","who":"Ada","reason":"wrong squares","robot":"r1"})");
  EXPECT_NE(
      ran.out.find("Session aaaaaaaaaaaaaaaa is current again, restored by Ada on 2026-02-01T12:00:00Z (wrong "
                   "squares); superseded by it: session bbbbbbbbbbbbbbbb. `rigcal restore bbbbbbbbbbbbbbbb` takes "
                   "that back.\n"),
      std::string::npos)
      << ran.out;
  EXPECT_NE(ran.out.find("r1, revision 2"), std::string::npos) << ran.out;
}

TEST(Standing, RetiringAnEdgeNeedsAReason) {
  const std::string done =
      R"({"robot":"r1","edge":{"id":"cccccccccccccccccccc","frame_a":"a","frame_b":"b","diagnoses":[{"code":"retired",)"
      R"("what":"retired on 2026-02-01 by Ada: typed wrong","cure":"Nothing"}]},"standing":{"number":9,"how":"retired",)"
      R"("at":"2026-02-01T12:00:00Z","who":"Ada","reason":"typed wrong"}})";
  FakeServer server("r1", Always(done));
  EXPECT_EQ(Rigcal({"retire", "cccccccc"}).code, 2);
  EXPECT_EQ(server.requests_seen, 0);
  const Ran ran = Rigcal({"retire", "cccccccc", "--reason", "typed wrong", "--no-wait"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "Edge cccccccccccccccc of r1, a - b, does not count any more: retired on 2026-02-01 by Ada: typed wrong. "
            "`rigcal restore cccccccccccccccc` takes that back.\n");
}

TEST(Standing, ARetiredSensorSaysHowItIsBroughtBack) {
  std::string asked, how = "retired";
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + json;
    return R"({"robot":"r1","sensor":"top","revision_follows":true,"standing":{"number":9,"how":")" + how +
           R"(","at":"2026-02-01T12:00:00Z","who":"Ada","reason":"taken off"}})";
  });
  const Ran gone = Rigcal({"retire", "top", "--robot", "r1", "--reason", "taken off", "--by", "Ada", "--no-wait"});
  EXPECT_EQ(asked, R"(retire{"thing":"top","who":"Ada","reason":"taken off","robot":"r1"})");
  EXPECT_EQ(gone.out,
            "Sensor top of r1 does not count any more: retired on 2026-02-01 by Ada: taken off. `rigcal restore top "
            "--robot r1` "
            "brings it back.\n");
  how = "restored";
  const Ran back = Rigcal({"restore", "top", "--robot", "r1", "--by", "Ada", "--no-wait"});
  EXPECT_EQ(asked, R"(restore{"thing":"top","who":"Ada","robot":"r1"})");
  EXPECT_EQ(back.out, "Sensor top of r1 counts again, restored by Ada on 2026-02-01T12:00:00Z (taken off).\n");
}

TEST(Standing, SessionsSayWhichWereRetired) {
  FakeServer server(
      "r1",
      Always(R"({"sessions":[{"session":"dddddddddddddddddddd","robot":"r1","state":"closed","retired":{"number":9,)"
             R"("how":"retired","at":"2026-02-01T12:00:00Z","who":"Ada","reason":"blurred"}}]})"));
  const Ran ran = Rigcal({"sessions"});
  EXPECT_NE(ran.out.find("  retired  "), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("Session dddddddddddddddd does not count: it was retired on 2026-02-01 by Ada: blurred. "
                         "`rigcal restore dddddddddddddddd` takes that back.\n"),
            std::string::npos)
      << ran.out;
}

TEST(Standing, ShowNamesRetiredSensors) {
  FakeServer server(
      "r1",
      Always(
          R"({"robot":"r1","revision":2,"document":{"robot":"r1","reference":"left","verdict":{"level":"pass"},)"
          R"("sensors":[],"retired_sensors":[{"sensor":"top","at":"2026-02-01T12:00:00Z","who":"Ada","reason":""}]}})"));
  const Ran ran = Rigcal({"show", "r1"});
  EXPECT_NE(ran.out.find("top was retired on 2026-02-01 by Ada. `rigcal restore top --robot r1` brings it back.\n"),
            std::string::npos)
      << ran.out;
}

TEST(Verbs, DueListsAlsoWhoNeedsSomebodyWhateverTheDate) {
  FakeServer server("r", [&](const std::string&, const std::string&) -> Result<std::string> {
    return std::string(R"({"max_age_ns":null,"robots":[)") +
           R"({"robot":"fine","overdue":false,"status":{"word":"ok","why":"all is well","next_step":"Nothing"}},)" +
           R"({"robot":"bumped","overdue":false,"status":{"word":"drifted","why":"right moved","next_step":"Check its mount."}}]})";
  });
  const Ran ran = Rigcal({"due"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("bumped  drifted  Check its mount.  right moved\n"), std::string::npos) << ran.out;
  EXPECT_EQ(ran.out.find("fine"), std::string::npos);
}

}  // namespace
}  // namespace rigcal::client
