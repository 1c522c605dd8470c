// `rigcal model`, `fleet` and `epoch`: what is asked, what is printed, how it ends.
#include <gtest/gtest.h>

#include "client/text/document.h"
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kMarsFile = R"(rig_model: mars
tolerance_mm: 10
tolerance_deg: 1
sensors:
  left: {type: camera}
  right: {type: camera, T_ref_sensor: {p_m: [0.2, 0.0, -0.05]}}
required_pairs: [[left, right]]
)";

class ModelVerb : public testing::Test {
 protected:
  std::string File(const std::string& text) {
    folder_.Write("mars.yaml", text);
    return (folder_.path() / "mars.yaml").string();
  }
  SessionFolder folder_;
};

void ExpectHas(const Ran& ran, const std::string& text) {
  EXPECT_NE(ran.out.find(text), std::string::npos) << text << "\n" << ran.out << ran.err;
}

TEST_F(ModelVerb, AFileIsCheckedWithoutAServer) {
  const Ran ran = Rigcal({"model", "check", File(kMarsFile)});
  EXPECT_EQ(ran.code, 0) << ran.err;
  ExpectHas(ran, "mars.yaml is good.");
  ExpectHas(ran, "Rig model mars, places in the frame of left");
  ExpectHas(ran, "200 0 -50");
  ExpectHas(ran, "required: left - right");
  const Ran wrong = Rigcal({"model", "check", File("rig_model: mars\nsensors: {left: {type: camra}}\n")});
  EXPECT_EQ(wrong.code, 4);
  EXPECT_NE(wrong.err.find("mars.yaml line 2"), std::string::npos) << wrong.err;
}

TEST_F(ModelVerb, OneIsSetWithItsText) {
  std::string asked_verb, asked;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked_verb = verb, asked = json;
    return R"({"robot":null,"revision_follows":false,"robots_waiting":17,"set":{"rig_model":"mars","version":2,"who":"Ada"}})";
  });
  const Ran ran = Rigcal({"model", "set", File(kMarsFile), "--reason", "drawing 7", "--by", "Ada"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked_verb, "set_rig_model");
  const auto parameters = Document::Parse(asked, "parameters");
  ASSERT_TRUE(parameters);
  EXPECT_EQ((*parameters)["text"].Text(), kMarsFile);
  EXPECT_EQ((*parameters)["reason"].Text(), "drawing 7");
  EXPECT_EQ(
      ran.out,
      "Rig model mars is version 2, set by Ada.\n17 robots are judged anew when the server has nothing else to do; "
      "`rigcal status` tells.\n");
  EXPECT_EQ(Rigcal({"model", "set", File(kMarsFile)}).code, 2) << "why?";
  EXPECT_EQ(Rigcal({"model", "show"}).code, 2) << "which one?";
}

TEST(FleetVerb, TellsWhoStandsOut) {
  std::string asked;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + json;
    return R"({"rig_model":"mars","reference":"left","robots":7,"why_not":null,"off_the_drawing":[],)"
           R"("outlier_texts":["r6: right sits 31 mm and 0.2 deg from where the others have it."],"left_out":[{"robot":"r9","why":"no calibration of it is in use"}],)"
           R"("too_few":[],"sensors":[{"id":"right","T_ref_nominal":{"p_m":[0,0,0]},"robots":7,"axes":[)"
           R"({"axis":"x","median_m":0.0012,"spread_m":0.0003,"min_m":-0.001,"max_m":0.031},)"
           R"({"axis":"rx","median_rad":0.01,"spread_rad":0.001,"min_rad":0,"max_rad":0.02},)"
           R"({"axis":"y","median_m":-1.23e-17,"spread_m":0.0003,"min_m":-2e-9,"max_m":2e-9}]}]})";
  });
  const Ran ran = Rigcal({"fleet", "mars"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, R"(population{"model":"mars"})");
  ExpectHas(ran, "Rig model mars, 7 robots with a calibration in use, told in the frame of left");
  ExpectHas(ran, "r6: right sits 31 mm");
  ExpectHas(ran, "right on 7 robots, from its nominal pose");
  ExpectHas(ran, "0.573");                                       // 0.01 rad
  ExpectHas(ran, "y     mm        0     0.3  -2e-06  2e-06\n");  // no more than arithmetic leaves over
  ExpectHas(ran, "left out: r9, no calibration of it is in use");
}

TEST(EpochVerb, NamesItsSensorsAndSaysWhatBecomesPast) {
  std::string asked;
  FakeServer server("r1", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + json;
    return R"({"robot":"r1","sensors":["left","top"],"begins_at":"2026-01-31T09:00:00Z","taken_back":false,)"
           R"("standing":{"number":4,"who":"Ada","reason":"new bracket"},"revision_follows":false})";
  });
  const Ran ran = Rigcal({"epoch", "r1", "--sensor", "left,top", "--reason", "new bracket", "--by", "Ada", "--at",
                          "2026-01-31T09:00:00Z"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(
      asked,
      R"(epoch{"robot":"r1","reason":"new bracket","who":"Ada","sensors":"left,top","at":"2026-01-31T09:00:00Z"})");
  EXPECT_EQ(ran.out,
            "An epoch of left, top of r1 began at 2026-01-31T09:00:00Z, says Ada: new bracket.\n"
            "What was measured of them before is past.\n");
  EXPECT_EQ(Rigcal({"epoch", "r1"}).code, 2) << "why?";
}

TEST(HistoryVerb, ListsEpochs) {
  FakeServer server("r1", [&](const std::string&, const std::string&) -> Result<std::string> {
    return R"({"robot":"r1","next":null,"epochs":[{"sensor":"left","begins_at":"2026-01-31T09:00:00Z","cause":"serial",)"
           R"("text":"the serial number of left is B7, before it was A1"}],"revisions":[{"revision":1,"created_at":"2026-01-31T12:00:00Z",)"
           R"("verdict":{"level":"pass","why":"so it is"},"state":"approved"}]})";
  });
  const Ran ran = Rigcal({"history", "r1"});
  ExpectHas(ran, "EPOCH FROM");
  ExpectHas(ran, "the serial number of left is B7, before it was A1");
}

}  // namespace
}  // namespace rigcal::client
