// `rigcal policy`: a file alone, what holds, and an order that sets it.
#include <gtest/gtest.h>

#include "client/text/document.h"
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kPolicy =
    R"({"scope":"robot","subject":"r1","limits":{"tolerance_m":0.003,"tolerance_rad":0.005,"moved_min_m":0.001,)"
    R"("moved_min_rad":0.00087266462599716479,"unseen_move_m":0.005,"unseen_move_rad":0.00524,"residual_max_m":0.05,)"
    R"("residual_max_rad":0.05,"max_age_ns":7776000000000000,"captures_min":20,"visits_in_full":12},)"
    R"("policy":{"rig_model":"mars","all":{"tolerance_m":0.003},"sensors":[{"id":"lidar","tolerance_m":0.02}],)"
    R"("pairs":[{"a":"left","b":"right","moved_min_m":0.002}]},)"
    R"("set":[{"scope":"fleet","subject":null,"version":3,"at":"2026-11-22T08:00:00Z","who":"Ada","reason":"new mounts"},)"
    R"({"scope":"robot","subject":"r1","version":1,"at":"2026-11-23T08:00:00Z","who":"Bob","reason":"it carries people"}]})";

class PolicyVerb : public testing::Test {
 protected:
  std::string File(const std::string& text) {
    folder_.Write("policy.yaml", text);
    return (folder_.path() / "policy.yaml").string();
  }
  SessionFolder folder_;
};

TEST_F(PolicyVerb, AFileIsCheckedWithoutAServer) {
  const std::string file = File(
      "tolerance_mm: 3\nsensors: {lidar: {tolerance_mm: 20}, body: {not_needed: [height]}}\n"
      "not_needed: [yaw]\n");
  const Ran ran = Rigcal({"policy", "check", file});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("policy.yaml is good"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("tolerance      3 "), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("lidar: tolerance_mm 20"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("body: not_needed height\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("all: tolerance_mm 3, not_needed yaw\n"), std::string::npos) << ran.out;
  const auto told = Document::Parse(Rigcal({"policy", "check", file, "--json"}).out, "check");
  ASSERT_TRUE(told);
  EXPECT_EQ((*told)["limits"]["tolerance_m"].Number(), 0.003);
}

TEST_F(PolicyVerb, AWrongFileIsToldByLineAndKey) {
  const Ran ran = Rigcal({"policy", "check", File("max_age_days: 30\ntolerance_m: 0.005\n")});
  EXPECT_EQ(ran.code, 4);
  EXPECT_NE(ran.err.find("policy.yaml line 2: tolerance_m: unknown key \"tolerance_m\"; write tolerance_mm: 5"),
            std::string::npos)
      << ran.err;
  EXPECT_EQ(Rigcal({"policy", "check", "/does/not/exist"}).code, 4);
}

TEST_F(PolicyVerb, WhatHoldsIsShownWithWhoSetIt) {
  std::string asked_verb, asked;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked_verb = verb, asked = json;
    return kPolicy;
  });
  const Ran ran = Rigcal({"policy", "show", "r1"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked_verb, "policy");
  EXPECT_EQ(asked, R"({"robot":"r1"})");
  for (const char* line :
       {"Policy of robot r1, rig model mars\n", "max_age 90 days, captures_min 20, visits_in_full 12\n",
        "lidar: tolerance_mm 20\n", "left - right: moved_min_mm 2\n",
        "Of the fleet, version 3, set by Ada on 22 Nov 2026: new mounts\n",
        "Of robot r1, version 1, set by Bob on 23 Nov 2026: it carries people\n"})
    EXPECT_NE(ran.out.find(line), std::string::npos) << line << "\n" << ran.out;
  (void)Rigcal({"policy", "show"});
  EXPECT_EQ(asked, "{}");
  (void)Rigcal({"policy", "show", "--model", "mars"});
  EXPECT_EQ(asked, R"({"model":"mars"})");
}

TEST_F(PolicyVerb, OneOfARobotWaitsForTheVerdictThatItGives) {
  std::string asked;
  int shown = 0;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    if (verb == "set_policy") {
      asked = json;
      return R"({"robot":"r1","revision_follows":true,"robots_waiting":1,"set":{"scope":"robot","subject":"r1","version":2,"who":"Ada"}})";
    }
    const std::string number = shown++ < 2 ? "5" : "6";
    if (verb == "status")
      return R"({"robots":[{"robot":"r1","revision":)" + number + R"(,"verdict":{"level":"warn"}}]})";
    return R"({"robot":"r1","revision":)" + number +
           R"(,"published":true,"drive":{"rule":"OK to drive"},"document":{"policy":{"versions":{"robot":)" +
           (number == "5" ? "1" : "2") + R"(}},"edges":[],"verdict":{"level":"warn","why":"so it is"}}})";
  });
  const Ran ran = Rigcal(
      {"policy", "set", File("tolerance_mm: 3\n"), "--robot", "r1", "--reason", "it carries people", "--by", "Ada"});
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_EQ(asked, R"({"reason":"it carries people","text":"tolerance_mm: 3\n","who":"Ada","robot":"r1"})");
  EXPECT_EQ(ran.out.find("The policy of robot r1 is version 2, set by Ada.\n"), 0U) << ran.out;
  EXPECT_NE(ran.out.find("r1, revision 6\n"), std::string::npos) << ran.out;
}

TEST_F(PolicyVerb, OneOfTheFleetSaysWhoIsJudgedAnew) {
  std::string asked;
  FakeServer server("r1", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return R"({"robot":null,"revision_follows":false,"robots_waiting":17,"set":{"scope":"fleet","subject":null,"version":4,"who":"Ada"}})";
  });
  const Ran ran = Rigcal({"policy", "set", File("max_age_days: 30\n"), "--reason", "new mounts", "--by", "Ada"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "The policy of the fleet is version 4, set by Ada.\n17 robots are judged anew when the server has nothing "
            "else to do; "
            "`rigcal status` tells.\n");
  (void)Rigcal({"policy", "set", File(""), "--reason", "x", "--by", "Ada", "--model", "mars"});
  EXPECT_EQ(asked, R"({"reason":"x","text":"","who":"Ada","model":"mars"})");
  (void)Rigcal({"policy", "set", File(""), "--reason", "x", "--by", "Ada", "--model", "mars", "--new-model"});
  EXPECT_EQ(asked, R"({"reason":"x","text":"","who":"Ada","model":"mars","new_model":true})");
  EXPECT_EQ(Rigcal({"policy", "set", File(""), "--reason", "x", "--new-model"}).code, 2) << "of which one?";
  EXPECT_EQ(Rigcal({"policy", "set", File("tolerance_mm: -1\n"), "--reason", "x"}).code, 4) << "nothing is asked";
}

}  // namespace
}  // namespace rigcal::client
