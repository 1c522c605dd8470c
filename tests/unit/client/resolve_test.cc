// rigcal resolve: asks, follows, tells what would change. Against a server in memory.
#include <chrono>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kRun =
    R"("run":3,"scope":"robot","subject":"r","scope_text":"robot r","cause":"re-computed with rigcal 0.2.0, estimator joint/7","who":"Ada",)";
constexpr const char* kDone =
    R"("done":true,"sessions":{"total":3,"done":3,"computed":2,"same":0,"kept":1,"failed":0},"robots_count":{"total":2,"done":2,"changed":1,"unchanged":1,"failed":0},)"
    R"("robots":[{"robot":"r","how":"changed","revision":5,"against":4,"state":"candidate","verdict":"pass","changes":[)"
    R"({"sensor":"right","how":"moved","moved_m":0.00123,"turned_rad":0.001,"sigmas":2.54},{"sensor":"rear","how":"lost","moved_m":null,"turned_rad":null,"sigmas":null}]},)"
    R"({"robot":"s","how":"unchanged","revision":null,"against":1,"state":null,"changes":[]}],)"
    R"("sessions_left":[{"robot":"r","session":"0123456789abcdef0123","how":"kept","why":"its files are gone."}])";

std::string Document(const std::string& rest) { return std::string("{") + kRun + rest + "}"; }

// Not done when it is asked for, and for one question more.
class ResolveServer {
 public:
  Result<std::string> Tell(const std::string& verb, const std::string& json) {
    asked.push_back(verb + " " + json);
    if (verb == "recomputation" && ++questions > 1) return Document(kDone);
    return Document(
        R"("new":true,"done":false,"sessions":{"total":3,"done":1},"robots_count":{"total":2,"changed":0},"robots":[],"sessions_left":[])");
  }
  std::vector<std::string> asked;
  int questions = 0;
};

TEST(ResolveVerb, AsksFollowsAndTellsWhatWouldChange) {
  ResolveServer told;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) { return told.Tell(verb, json); });
  const Ran ran = Rigcal({"resolve", "r", "--by", "Ada"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  ASSERT_EQ(told.asked.size(), 4U);
  EXPECT_EQ(told.asked[0], R"(resolve {"robot":"r","who":"Ada"})");
  EXPECT_EQ(told.asked[1], R"(recomputation {"limit":0,"run":3})");
  EXPECT_EQ(told.asked[3], R"(recomputation {"limit":1000,"run":3})");
  EXPECT_NE(ran.err.find("Ctrl-C leaves it: the server goes on"), std::string::npos) << ran.err;
  EXPECT_EQ(ran.out.find("Run 3: robot r, re-computed with rigcal 0.2.0, estimator joint/7, asked for by Ada.\n"
                         "3 sessions: 2 computed again, 1 kept as they are. 2 robots: 1 changed, 1 unchanged.\n"),
            0U)
      << ran.out;
  EXPECT_NE(ran.out.find("right       1.23       0.057     2.5\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("rear        lost"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("Candidates are used by no robot until a person approves them"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("unchanged: s\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("session 0123456789abcdef of robot r is kept as it is: its files are gone.\n"),
            std::string::npos)
      << ran.out;
}

TEST(ResolveVerb, StatusAsksForNothing) {
  ResolveServer told;
  told.questions = 1;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) { return told.Tell(verb, json); });
  const Ran ran = Rigcal({"resolve", "--status", "--json"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(told.asked.front(), R"(recomputation {"limit":0})");
  for (const std::string& asked : told.asked) EXPECT_EQ(asked.find("recomputation "), 0U) << asked;
  EXPECT_EQ(ran.out, Document(kDone) + "\n");
}

TEST(ResolveVerb, NoWaitTellsHowFarItIs) {
  ResolveServer told;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) { return told.Tell(verb, json); });
  const Ran ran = Rigcal({"resolve", "--all", "--no-wait", "--by", "Ada"});
  EXPECT_EQ(told.asked.front(), R"(resolve {"all":true,"who":"Ada"})");
  EXPECT_NE(
      ran.out.find("It goes on: 1 of 3 sessions and 0 of 2 robots are done. `rigcal resolve --status` follows it.\n"),
      std::string::npos)
      << ran.out;
}

TEST(ResolveVerb, RobotsWithoutSessionsAreCountedAndACutListSaysSo) {
  FakeServer server(
      "r",
      Always(Document(
          R"("done":false,"sessions":{"total":0,"done":0},"robots_count":{"total":3000,"done":1200,"changed":0,"unchanged":1200,"failed":0},)"
          R"("robots":[{"robot":"s","how":"unchanged","revision":null,"against":1,"state":null,"changes":[]}],"sessions_left":[])")));
  const Ran ran = Rigcal({"resolve", "--status", "--no-wait"});
  EXPECT_NE(ran.out.find("It goes on: 1200 of 3000 robots are done. `rigcal resolve --status` follows it.\n"),
            std::string::npos)
      << ran.out;
  EXPECT_NE(ran.out.find("unchanged: s\nand 1199 more robots, not listed here\n"), std::string::npos) << ran.out;
}

TEST(ResolveVerb, NobodyWaitsLongerThanWasSaid) {
  const auto began = std::chrono::steady_clock::now();
  const Ran ran = Rigcal({"resolve", "--status", "--timeout-total", "0.3"});
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
}

TEST(ResolveVerb, WhatFailedIsTheExitCode) {
  FakeServer server(
      "r",
      Always(Document(
          R"("done":true,"sessions":{"total":1,"done":1,"failed":1},"robots_count":{"total":1,"unchanged":1},"robots":[],"sessions_left":[])")));
  EXPECT_EQ(Rigcal({"resolve", "--status"}).code, 6);
}

TEST(ResolveVerb, OneScopeIsNeeded) {
  EXPECT_EQ(Rigcal({"resolve"}).code, 2);
  EXPECT_EQ(Rigcal({"resolve", "r", "--all"}).code, 2);
  EXPECT_EQ(Rigcal({"resolve", "--status", "--all"}).code, 2);
  EXPECT_EQ(Rigcal({"resolve", "--all", "--run", "3"}).code, 2);
}

// In whichever order they stand, and though one of them is an empty word of a script.
TEST(ResolveVerb, TwoScopesAreRefusedInOneSentence) {
  for (const std::vector<std::string>& scopes : std::vector<std::vector<std::string>>{
           {"--all", "--board", "B-7"}, {"--board", "B-7", "--all"}, {"--board", "", "--all"}}) {
    std::vector<std::string> words = {"resolve"};
    words.insert(words.end(), scopes.begin(), scopes.end());
    const Ran ran = Rigcal(words);
    EXPECT_EQ(ran.code, 2);
    EXPECT_EQ(ran.err.substr(0, ran.err.find('\n')),
              "rigcal: --all and --board contradict each other: name one of them");
  }
  EXPECT_NE(Rigcal({"resolve", "--board", ""}).err.find("A name after --board is required"), std::string::npos);
}

TEST(CommandLine, AnOptionIsNoValueOfTheOneBefore) {
  EXPECT_NE(Rigcal({"resolve", "--board", "--all"}).err.find("--board: needs a value, and --all is an option"),
            std::string::npos);
  EXPECT_NE(Rigcal({"approve", "r", "4", "--reason", "--by", "Ada"})
                .err.find("--reason: needs a value, and --by is an option"),
            std::string::npos);
  EXPECT_NE(Rigcal({"resolve", "--board", "--json"}).err.find("--board: needs a value, and --json is an option"),
            std::string::npos);
  EXPECT_EQ(Rigcal({"approve", "r", "4", "--reason", "--by now it is right"}).err.find("is an option"),
            std::string::npos);
}

}  // namespace
}  // namespace rigcal::client
