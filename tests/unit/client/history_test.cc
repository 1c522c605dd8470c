// What a robot's history holds, by pages; and whose edges are told whole. Against a server in memory.
#include "server/formats/documents.h"
#include "tests/unit/client/run.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::client {
namespace {

TEST(HistoryVerbs, HistoryListsRevisionsByPages) {
  std::string asked;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return R"({"robot":"r","revisions":[{"revision":9,"created_at":"2026-01-31T12:00:00Z","verdict":{"level":"warn","why":"one edge is far off"},"state":"candidate"},)"
           R"({"revision":8,"created_at":"2026-01-24T12:00:00Z","verdict":{"level":"fail","why":"a camera moved"}}],"next":8})";
  });
  Ran ran = Rigcal({"history", "r"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, R"(revisions {"robot":"r","limit":20})");
  EXPECT_NE(ran.out.find("       9  2026-01-31T12:00:00Z  warn     candidate  one edge is far off\n"),
            std::string::npos)
      << ran.out;
  EXPECT_LT(ran.out.find("2026-01-31"), ran.out.find("2026-01-24"));
  EXPECT_NE(ran.out.find("There are older ones: `rigcal history r --limit 20 --before 8`\n"), std::string::npos)
      << ran.out;
  ran = Rigcal({"history", "r", "--limit", "2", "--before", "10", "--json"});
  EXPECT_EQ(asked, R"(revisions {"robot":"r","limit":2,"before":10})");
  EXPECT_EQ(ran.out.front(), '{');
}

TEST(HistoryVerbs, HistoryTellsWhatSessionsFound) {
  FakeServer server(
      "r",
      Always(
          R"({"robot":"r","revisions":[{"revision":9,"created_at":"2026-01-31T12:00:00Z","verdict":{"level":"pass","why":"well"},"state":"candidate",)"
          R"("as_found":{"session":"aa","state":"drifted","drifted":["right","top"]}},)"
          R"({"revision":8,"created_at":"2026-01-24T12:00:00Z","verdict":{"level":"pass","why":"well"},"state":"superseded","as_found":{"state":"not_measured","drifted":[]}},)"
          R"({"revision":7,"created_at":"2026-01-17T12:00:00Z","verdict":{"level":"pass","why":"pushed"}}],"next":null})"));
  const Ran ran = Rigcal({"history", "r"});
  EXPECT_NE(ran.out.find("VERDICT  STATE       AS FOUND            WHY\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("pass     candidate   right, top drifted  well\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("pass     superseded  nothing told        well\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("pass     -                               pushed\n"), std::string::npos) << ran.out;
}

TEST(HistoryVerbs, ShowTellsWhatTheNewestSessionFound) {
  FakeServer server(
      "r",
      Always(
          R"({"robot":"r","revision":2,"as_found":{"text":"As found (session of 2026-11-03): left unchanged."},"document":{}})"));
  EXPECT_NE(Rigcal({"show", "r"}).out.find("As found (session of 2026-11-03): left unchanged.\n"), std::string::npos);
}

TEST(HistoryVerbs, ListsAreAskedForByPages) {
  std::string asked;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return R"({"sessions":[],"edges":[],"next":"abc"})";
  });
  EXPECT_NE(Rigcal({"sessions", "--limit", "5"}).out.find("`rigcal sessions --limit 5 --before abc`"),
            std::string::npos);
  EXPECT_EQ(asked, R"(sessions {"limit":5})");
  EXPECT_NE(Rigcal({"sessions", "r", "--limit", "5", "--before", "ab"})
                .out.find("`rigcal sessions r --limit 5 --before abc`"),
            std::string::npos);
  EXPECT_EQ(asked, R"(sessions {"robot":"r","limit":5,"before":"ab"})");
  EXPECT_NE(Rigcal({"edges", "r", "--before", "ab"}).out.find("`rigcal edges r --before abc`"), std::string::npos);
  EXPECT_EQ(asked, R"(edges {"robot":"r","before":"ab"})");
  (void)Rigcal({"edges", "r", "--in", "0123456789ab"});
  EXPECT_EQ(asked, R"(edges {"robot":"r","in":"0123456789ab"})");
  EXPECT_NE(Rigcal({"edges", "r", "--in", "0123456789ab", "--limit", "5"})
                .out.find("`rigcal edges r --in 0123456789ab --limit 5 --before abc`"),
            std::string::npos);
}

TEST(HistoryVerbs, ExportAsksForWholeEdgesAndTakesWhatOlderServersGive) {
  SessionFolder folder;
  const std::string file = (folder.path() / "r.g2o").string();
  const formats::RevisionInput revision = formats::samples::SampleRevision();
  std::string asked, document = formats::WriteWholeRevisionDocument(revision);
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return R"({"revision":3,"document":)" + document + "}";
  });
  EXPECT_EQ(Rigcal({"export", "r", "--out", file}).code, 0);
  EXPECT_EQ(asked, R"({"robot":"r","whole":true})");
  document = formats::WriteRevisionDocument(revision);
  const Ran ran = Rigcal({"export", "r", "--out", file});
  EXPECT_EQ(ran.code, 4);
  EXPECT_NE(ran.err.find("the server's document has no information matrices"), std::string::npos) << ran.err;
}

TEST(HistoryVerbs, ShowTellsEdgesWholeWhenItIsAskedTo) {
  std::string asked;
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return R"({"document":{}})";
  });
  (void)Rigcal({"show", "r", "--whole", "--json"});
  EXPECT_EQ(asked, R"({"robot":"r","whole":true})");
  (void)Rigcal({"show", "r"});
  EXPECT_EQ(asked, R"({"robot":"r"})");
}

}  // namespace
}  // namespace rigcal::client
