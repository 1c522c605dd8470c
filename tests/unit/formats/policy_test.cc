// The policy as people write it, and as documents keep it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/formats/answers/answers.h"
#include "server/formats/json/json_field.h"
#include "server/formats/revision/policy_fields.h"
#include "server/formats/yaml/policy_yaml.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

constexpr const char* kWhole = R"(# limits of the mapping fleet
tolerance_mm: 4
tolerance_deg: 0.2
tolerance_px_at_10_m: 1.5
moved_min_mm: 0.5
moved_min_deg: 0.02
unseen_move_mm: 6
unseen_move_deg: 0.4
residual_max_mm: 40
residual_max_deg: 2
max_age_days: 30.5
captures_min: 20
approval: person
approve_warnings: false
approve_drift: false
drift_false_alarm_percent: 1
visits_in_full: 12
sensors:
  lidar: {tolerance_mm: 20, moved_min_mm: 3}
  left: {tolerance_px_at_10_m: 1}
  body: {not_needed: [height, yaw]}
pairs:
  right - left: {tolerance_mm: 2, moved_min_deg: 0.1}
)";

std::string Refused(const std::string& text) {
  const Result<Policy> read = ReadPolicy(text, "policy.yaml");
  EXPECT_FALSE(read) << text;
  return read ? "" : read.error().what;
}

TEST(PolicyYaml, EveryKeyIsRead) {
  const Result<Policy> read = ReadPolicy(kWhole, "policy.yaml");
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->all.tolerance_m, 0.004);
  EXPECT_DOUBLE_EQ(*read->all.tolerance_rad, 0.2 * M_PI / 180);
  EXPECT_EQ(read->all.tolerance_px_at_10_m, 1.5);
  EXPECT_EQ(read->all.moved_min_m, 0.0005);
  EXPECT_DOUBLE_EQ(*read->all.moved_min_rad, 0.02 * M_PI / 180);
  EXPECT_EQ(read->all.unseen_move_m, 0.006);
  EXPECT_DOUBLE_EQ(*read->all.unseen_move_rad, 0.4 * M_PI / 180);
  EXPECT_EQ(read->residual_max_m, 0.04);
  EXPECT_DOUBLE_EQ(*read->residual_max_rad, 2 * M_PI / 180);
  EXPECT_EQ(read->max_age_ns, 30LL * 86'400'000'000'000 + 43'200'000'000'000);
  EXPECT_EQ(read->captures_min, 20);
  EXPECT_EQ(read->visits_in_full, 12);
  EXPECT_EQ(read->approval, ApprovalBy::kPerson);
  EXPECT_EQ(read->approve_warnings, false);
  EXPECT_EQ(read->approve_drift, false);
  EXPECT_EQ(read->drift_false_alarm_ratio, 0.01);
  ASSERT_EQ(read->sensors.size(), 3u);
  EXPECT_EQ(read->sensors.at(SensorId("lidar")).moved_min_m, 0.003);
  EXPECT_FALSE(read->sensors.at(SensorId("lidar")).moved_min_rad);
  ASSERT_EQ(read->pairs.size(), 1u);
  EXPECT_EQ(read->pairs.at({SensorId("left"), SensorId("right")}).tolerance_m, 0.002);
}

TEST(PolicyYaml, WhatIsNotNeededIsAListOfResults) {
  const Result<Policy> read = ReadPolicy(kWhole, "policy.yaml");
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(NotNeededOf(*read, SensorId("body")), (std::set<std::string>{"height", "yaw"}));
  EXPECT_TRUE(NotNeededOf(*read, SensorId("left")).empty());
  const Result<Policy> of_all =
      ReadPolicy("not_needed: [z of left]\nsensors: {body: {not_needed: []}}\n", "policy.yaml");
  ASSERT_TRUE(of_all) << Sentence(of_all.error());
  EXPECT_EQ(NotNeededOf(*of_all, SensorId("left")), std::set<std::string>{"z of left"});
  EXPECT_TRUE(NotNeededOf(*of_all, SensorId("body")).empty()) << "of this one all is needed";
  EXPECT_THAT(
      Refused("sensors:\n  body: {not_needed: [hieght]}\n"),
      testing::HasSubstr("policy.yaml line 2: sensor 'body': not_needed: \"hieght\" is no result of a pose; did "
                         "you mean \"height\"?"));
  EXPECT_THAT(Refused("not_needed: [z]\n"),
              testing::HasSubstr("not_needed: \"z\" is another axis with another reference sensor"));
  EXPECT_THAT(ReadPolicy("not_needed: [z]\n", "policy.yaml").error().cure,
              testing::HasSubstr("forward, sideways, height, roll, pitch or yaw of the robot, or whose axis it is: "
                                 "not_needed: [z of SENSOR]."));
  EXPECT_THAT(Refused("not_needed: [z of ]\n"), testing::HasSubstr("is no result of a pose"));
  EXPECT_THAT(Refused("not_needed: [height of left]\n"), testing::HasSubstr("is no result of a pose"));
  EXPECT_THAT(Refused("not_needed: height\n"), testing::HasSubstr("not_needed: must be a list"));
  EXPECT_THAT(Refused("pairs: {a - b: {not_needed: [height]}}\n"), testing::HasSubstr("unknown key \"not_needed\""));
}

TEST(PolicyYaml, NothingIsAPolicyThatSaysNothing) {
  for (const char* text : {"", "# later\n"}) EXPECT_EQ(ReadPolicy(text, "policy.yaml").value(), Policy());
}

TEST(PolicyYaml, AnUnknownKeyIsToldWhatItMayMean) {
  EXPECT_EQ(Refused("tolerence_mm: 5"),
            "policy.yaml line 1: tolerence_mm: unknown key \"tolerence_mm\"; did you mean "
            "\"tolerance_mm\"?");
  EXPECT_EQ(Refused("max_age_days: 90\nsensors:\n  left: {tolerance: 5}"),
            "policy.yaml line 3: sensor 'left': unknown key \"tolerance\"; did you mean \"tolerance_mm\"?");
  EXPECT_EQ(Refused("pairs:\n  a - b: {unseen_move_mm: 5}"),
            "policy.yaml line 2: pair 'a - b': unknown key \"unseen_move_mm\"; known here: tolerance_mm, "
            "tolerance_deg, moved_min_mm and moved_min_deg");
}

TEST(PolicyYaml, AWrongUnitIsToldInTheRightOne) {
  EXPECT_EQ(Refused("tolerance_m: 0.005"),
            "policy.yaml line 1: tolerance_m: unknown key \"tolerance_m\"; write tolerance_mm: 5");
  EXPECT_EQ(Refused("moved_min_mrad: 2"),
            "policy.yaml line 1: moved_min_mrad: unknown key \"moved_min_mrad\"; write moved_min_deg: 0.114592");
  EXPECT_EQ(Refused("max_age_weeks: 2"),
            "policy.yaml line 1: max_age_weeks: unknown key \"max_age_weeks\"; write max_age_days: 14");
  EXPECT_EQ(Refused("sensors: {left: {tolerance_mm: 2 cm}}"),
            "policy.yaml line 1: sensor 'left': tolerance_mm: is in mm: write 20, not \"2 cm\"");
  EXPECT_EQ(Refused("tolerance_deg: 5mrad"),
            "policy.yaml line 1: tolerance_deg: is in deg: write 0.286479, not \"5mrad\"");
  EXPECT_EQ(Refused("tolerance_mm: 5 deg"), "policy.yaml line 1: tolerance_mm: must be a number, not \"5 deg\"");
}

TEST(PolicyYaml, ALimitIsAboveZero) {
  EXPECT_EQ(Refused("tolerance_mm: -5"), "policy.yaml line 1: tolerance_mm: must be from 0.001 to 10000, not \"-5\"");
  EXPECT_EQ(Refused("tolerance_deg: 0"), "policy.yaml line 1: tolerance_deg: must be from 0.0001 to 180, not \"0\"");
  EXPECT_EQ(Refused("max_age_days: -1"),
            "policy.yaml line 1: max_age_days: must be from 0.0416667 (1 h) to 36500, not \"-1\"");
  for (const char* wrong : {"4", "33", "8.5", "all"})
    EXPECT_EQ(
        Refused(std::string("visits_in_full: ") + wrong),
        std::string("policy.yaml line 1: visits_in_full: must be a whole number from 5 to 32, not \"") + wrong + "\"");
  EXPECT_EQ(Refused("captures_min: 0"),
            "policy.yaml line 1: captures_min: must be a whole number from 1 to 100000, not \"0\"");
  EXPECT_EQ(Refused("tolerance_mm: nan"), "policy.yaml line 1: tolerance_mm: must be a number, not \"nan\"");
  EXPECT_EQ(Refused("tolerance_mm:"), "policy.yaml line 1: tolerance_mm: has no value");
}

TEST(PolicyYaml, WhoApprovesIsOneOfTwo) {
  EXPECT_EQ(ReadPolicy("approval: automatic", "policy.yaml")->approval, ApprovalBy::kAutomatic);
  EXPECT_EQ(Refused("approval: Ada"), "policy.yaml line 1: approval: must be automatic or person, not \"Ada\"");
  EXPECT_EQ(Refused("drift_false_alarm_percent: 50"),
            "policy.yaml line 1: drift_false_alarm_percent: must be from 0.001 to 10, not \"50\"");
  EXPECT_EQ(Refused("approve_warnings: yes"),
            "policy.yaml line 1: approve_warnings: must be true or false, not \"yes\"");
}

// What becomes 0, or next to it, in the unit in which it is kept.
TEST(PolicyYaml, ALimitThatJudgesNothingIsRefused) {
  EXPECT_EQ(Refused("max_age_days: 1e-15"),
            "policy.yaml line 1: max_age_days: must be from 0.0416667 (1 h) to 36500, not \"1e-15\"");
  EXPECT_EQ(Refused("tolerance_px_at_10_m: 1e-320"),
            "policy.yaml line 1: tolerance_px_at_10_m: must be from 0.001 to 10000, not \"1e-320\"");
  EXPECT_EQ(Refused("pairs: {a - b: {moved_min_deg: 1e-5}}"),
            "policy.yaml line 1: pair 'a - b': moved_min_deg: must be from 0.0001 to 180, not \"1e-5\"");
  for (const char* key : {"tolerance_mm", "tolerance_deg", "unseen_move_mm", "residual_max_mm", "residual_max_deg"})
    EXPECT_THAT(Refused(key + std::string(": 1e-322")), testing::HasSubstr("must be from 0.0"));
}

TEST(PolicyYaml, TheLeastThatIsToldIsTaken) {
  const auto read =
      ReadPolicy("tolerance_mm: 0.001\ntolerance_deg: 0.0001\ntolerance_px_at_10_m: 0.001\nmax_age_days: 0.0416667\n",
                 "policy.yaml");
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_DOUBLE_EQ(*read->all.tolerance_m, 1e-6);
  EXPECT_GT(*read->all.tolerance_rad, 0.0);
  EXPECT_GE(*read->max_age_ns, 3'600'000'000'000);
}

// Texts of before there was a least value: robots are judged all the same.
TEST(PolicyYaml, AStoredLimitCountsAsTheLeast) {
  const auto read = ReadStoredPolicy(
      "tolerance_mm: 1e-322\nmax_age_days: 1e-15\ntolerance_px_at_10_m: 1e-320\nsensors: {left: {tolerance_deg: "
      "1e-9}}\n"
      "pairs: {a - b: {moved_min_mm: 1e-9}}\nresidual_max_mm: 1e-322\nresidual_max_deg: 3\n",
      "policy.yaml");
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_DOUBLE_EQ(*read->all.tolerance_m, 1e-6);
  EXPECT_EQ(read->max_age_ns, 3'600'000'000'000);
  EXPECT_EQ(read->all.tolerance_px_at_10_m, 0.001);
  EXPECT_DOUBLE_EQ(*read->sensors.at(SensorId("left")).tolerance_rad, 1e-4 * M_PI / 180);
  EXPECT_DOUBLE_EQ(*read->pairs.at({SensorId("a"), SensorId("b")}).moved_min_m, 1e-6);
  EXPECT_DOUBLE_EQ(*read->residual_max_m, 1e-6);
  EXPECT_DOUBLE_EQ(*read->residual_max_rad, 3 * M_PI / 180);
  EXPECT_FALSE(ReadStoredPolicy("tolerance_mm: 0\n", "policy.yaml"));
}

TEST(PolicyYaml, NamesAreThoseOfSensors) {
  EXPECT_EQ(
      Refused("pairs: {left-right: {tolerance_mm: 5}}"),
      "policy.yaml line 1: pairs: left-right: a pair is written as two sensors, `left - right`, not \"left-right\"");
  EXPECT_EQ(Refused("pairs: {a - a: {tolerance_mm: 5}}"),
            "policy.yaml line 1: pairs: a - a: a pair is of two sensors, not of \"a - a\"");
  EXPECT_EQ(Refused("pairs:\n  a - b: {tolerance_mm: 5}\n  b - a: {tolerance_mm: 6}"),
            "policy.yaml line 3: pair 'a - b': is there twice");
  EXPECT_THAT(Refused("sensors: {'../x': {tolerance_mm: 5}}"), testing::HasSubstr("\"../x\""));
  EXPECT_EQ(Refused("sensors: [left]"), "policy.yaml line 1: sensors: must be a map of names and values");
}

TEST(PolicyYaml, IsBounded) {
  EXPECT_THAT(Refused(std::string(kPolicyBytesMax + 1, '#')), testing::HasSubstr("32768"));
}

TEST(PolicyFields, WhatIsSaidComesBack) {
  PolicyInForce in_force{ReadPolicy(kWhole, "policy.yaml").value(), "mars", 3, 0, 12, 77};
  in_force.policy.focal_px[SensorId("left")] = 812.5;
  const std::string text = WriteObject([&](JsonWriter& out) { WritePolicyMembers(out, in_force); });
  Result<JsonDocument> document = JsonDocument::Parse(text, {"policy", "", 1 << 20});
  ASSERT_TRUE(document);
  const PolicyInForce read = ReadPolicyMembers(document->Root());
  ASSERT_TRUE(document->status()) << Sentence(document->status().error());
  EXPECT_EQ(read.policy, in_force.policy);
  EXPECT_EQ(read.rig_model, "mars");
  EXPECT_EQ(read.fleet, 3);
  EXPECT_EQ(read.model, 0);
  EXPECT_EQ(read.robot, 12);
}

// As documents have it that were written before a limit had a least value.
TEST(PolicyFields, ALimitOfZeroIsNone) {
  PolicyInForce in_force;
  in_force.policy.all.tolerance_m = 0.0;
  in_force.policy.sensors[SensorId("left")].tolerance_px_at_10_m = 0.0;
  in_force.policy.pairs[{SensorId("a"), SensorId("b")}].moved_min_m = 0.002;
  in_force.policy.residual_max_m = 0.0;
  in_force.policy.max_age_ns = 0;
  in_force.policy.focal_px[SensorId("left")] = 0.0;
  const std::string text = WriteObject([&](JsonWriter& out) { WritePolicyMembers(out, in_force); });
  Result<JsonDocument> document = JsonDocument::Parse(text, {"policy", "", 1 << 20});
  ASSERT_TRUE(document);
  const PolicyInForce read = ReadPolicyMembers(document->Root());
  ASSERT_TRUE(document->status()) << Sentence(document->status().error());
  EXPECT_FALSE(read.policy.all.tolerance_m);
  EXPECT_FALSE(read.policy.sensors.at(SensorId("left")).tolerance_px_at_10_m);
  EXPECT_EQ(read.policy.pairs.at({SensorId("a"), SensorId("b")}).moved_min_m, 0.002);
  EXPECT_FALSE(read.policy.residual_max_m);
  EXPECT_FALSE(read.policy.max_age_ns);
  EXPECT_TRUE(read.policy.focal_px.empty());
}

// A revision says by what it was judged, and beside each sigma what it is held against.
TEST(PolicyFields, ARevisionKeepsWhatJudgedIt) {
  RevisionInput input = samples::SampleRevision();
  input.policy = PolicyInForce{ReadPolicy(kWhole, "policy.yaml").value(), "mars", 3, 1, 0, 77};
  input.verdict.unverified = "top";
  const std::string text = WriteRevisionDocument(input);
  const json document = json::parse(text);
  EXPECT_EQ(document["policy"]["versions"], (json{{"fleet", 3}, {"model", 1}, {"robot", 0}}));
  for (const json& sensor : document["sensors"]) {
    EXPECT_EQ(sensor["tolerance_m"], sensor["id"] == "lidar" ? 0.02 : 0.004);
    EXPECT_TRUE(sensor.contains("tolerance_rad"));
  }
  const Result<RevisionInput> read = ReadRevisionDocument(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_TRUE(read->policy);
  EXPECT_EQ(read->policy->policy, input.policy->policy);
  EXPECT_EQ(read->verdict.unverified, "top");
  EXPECT_EQ(WriteRevisionDocument(*read), text);
  EXPECT_FALSE(json::parse(WriteRevisionDocument(samples::SampleRevision())).contains("policy"));
}

TEST(PolicyAnswer, TellsWhatHoldsAndWhoSetIt) {
  const PolicyVersion set{{PolicyScope::kRobot, "r"}, 9, 2, {{0}, "Ada", "new mounts"}, "tolerance_mm: 4\n"};
  PolicyInForce in_force;
  in_force.policy.all.tolerance_m = 0.004;
  in_force.robot = 2;
  const json told = json::parse(WritePolicy({set.place, in_force, {set}}));
  EXPECT_EQ(told["scope"], "robot");
  EXPECT_EQ(told["subject"], "r");
  EXPECT_EQ(told["limits"]["tolerance_m"], 0.004);
  EXPECT_EQ(told["limits"]["moved_min_m"], 0.001);
  EXPECT_EQ(told["limits"]["max_age_ns"], kDefaultMaxAge_ns);
  EXPECT_TRUE(told["limits"]["captures_min"].is_null());
  EXPECT_EQ(told["limits"]["visits_in_full"], kDefaultVisitsInFull);
  EXPECT_EQ(told["limits"]["approval"], "automatic");
  EXPECT_EQ(told["limits"]["approve_warnings"], true);
  EXPECT_EQ(told["set"][0]["who"], "Ada");
  EXPECT_EQ(told["set"][0]["text"], "tolerance_mm: 4\n");
  EXPECT_EQ(told["set"][0]["version"], 2);
  const json done = json::parse(WritePolicySet(set, 1));
  EXPECT_EQ(done["set"]["version"], 2);
  EXPECT_EQ(done["robots_waiting"], 1);
  EXPECT_EQ(done["revision_follows"], true);
  EXPECT_EQ(json::parse(WritePolicySet({}, 7))["revision_follows"], false);
}

}  // namespace
}  // namespace rigcal::formats
