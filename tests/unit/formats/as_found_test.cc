// What a session found of the calibration in use, as JSON and back.
#include "server/formats/revision/as_found.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "server/formats/answers/answers.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

// The height of the first sensor was not measured; nothing would show of its turns about x.
AsFound SomeFound() {
  AsFound found;
  found.session = SessionId(std::string(64, 'a'));
  found.captured_at = ParseIso("2026-11-03T10:00:00Z").value();
  found.in_use = 2;
  found.made_at = ParseIso("2026-10-03T10:00:00Z").value();
  found.tests = 11;
  found.visits = 4;
  found.scatter_robots = 9;
  found.relative_to = SensorId("left");
  found.text = "As found: \"right\" moved,\"document\":null.";
  SensorFound right, top;
  right.sensor = SensorId("right");
  right.state = FoundState::kDrifted;
  right.or_else = SensorId("left");
  right.axes.fill(FoundState::kUnchanged);
  right.axes[0] = FoundState::kDrifted, right.axes[2] = FoundState::kNotMeasured;
  right.change << 0.001, 0.002, 0, 0.003, 0.004, 0.005;
  right.sigma << 0.0001, 0.0002, 0, 0.0003, 0.0004, 0.0005;
  right.smallest << 0.0006, 0.0012, 0, std::numeric_limits<double>::infinity(), 0.0024, 0.003;
  right.left = Vector6d::Constant(1e-5);
  right.rate = DriftRate{3, {1'000'000'000}, {2'000'000'000}, 1e-4 * Vector6d::Ones(), 2e-4 * Vector6d::Ones()};
  top.sensor = SensorId("top");
  top.state = FoundState::kMovedOnPurpose;
  found.sensors = {right, top};
  return found;
}

TEST(AsFoundDocument, ComesBack) {
  const AsFound given = SomeFound();
  const auto read = ReadAsFound(WriteAsFound(given));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(WriteAsFound(*read), WriteAsFound(given));
  EXPECT_EQ(read->made_at, given.made_at);
  EXPECT_EQ(read->relative_to, given.relative_to);
  EXPECT_EQ(read->scatter_robots, 9);
  ASSERT_EQ(read->sensors.size(), 2u);
  const SensorFound &right = read->sensors[0], &of = given.sensors[0];
  EXPECT_EQ(right.axes, of.axes);
  EXPECT_EQ(right.change, of.change);
  EXPECT_EQ(right.sigma, of.sigma);
  EXPECT_EQ(right.smallest, of.smallest);
  EXPECT_EQ(right.left, of.left);
  EXPECT_EQ(right.rate->per_30_days, of.rate->per_30_days);
  EXPECT_EQ(right.rate->last, of.rate->last);
  EXPECT_FALSE(read->sensors[1].left);
}

TEST(AsFoundDocument, HasNullForWhatIsNotKnown) {
  const json document = json::parse(WriteAsFound(SomeFound()));
  EXPECT_EQ(document["state"], "drifted");
  EXPECT_EQ(document["in_use"]["revision"], 2);
  const json right = document["sensors"][0];
  EXPECT_EQ(right["change"], (json{0.001, 0.002, nullptr, 0.003, 0.004, 0.005}));
  EXPECT_EQ(right["axes"][2], "not_measured");
  EXPECT_TRUE(right["smallest"][3].is_null());
  EXPECT_EQ(document["smallest_m"], 0.0012);
  EXPECT_TRUE(document["smallest_rad"].is_null());
  EXPECT_EQ(document["sensors"][1]["change"][0], nullptr);
  AsFound first = SomeFound();
  first.in_use = 0, first.tests = 0, first.sensors.clear(), first.made_at.reset(), first.relative_to = {};
  first.why_not = "No calibration was in use before it.";
  const json none = json::parse(WriteAsFound(first));
  EXPECT_TRUE(none["in_use"].is_null() && none["smallest_m"].is_null() && none["relative_to"].is_null());
  EXPECT_EQ(ReadAsFound(none.dump())->why_not, first.why_not);
}

TEST(AsFoundDocument, HasByWhatOneSitsElsewhereThatIsNotToldApart) {
  AsFound given = SomeFound();
  EXPECT_EQ(WriteAsFound(given).find("elsewhere"), std::string::npos);
  given.elsewhere = Vector6d::Constant(2e-3);
  given.sensors[0].elsewhere = Vector6d::Constant(3e-3);
  given.sensors[0].state = given.sensors[0].axes[1] = FoundState::kNotToldApart;
  const auto read = ReadAsFound(WriteAsFound(given));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(WriteAsFound(*read), WriteAsFound(given));
  EXPECT_EQ(read->elsewhere, given.elsewhere);
  EXPECT_EQ(read->sensors[0].elsewhere, given.sensors[0].elsewhere);
  EXPECT_EQ(read->sensors[0].change, given.sensors[0].change) << "that axis has its numbers";
}

TEST(AsFoundDocument, RefusesWhatIsNoState) {
  json document = json::parse(WriteAsFound(SomeFound()));
  document["sensors"][0]["state"] = "wandered";
  const auto read = ReadAsFound(document.dump());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().what.find("wandered"), std::string::npos) << read.error().what;
}

TEST(AsFoundDocument, StandsBesideTheDocumentOfARevisionAndInItsRow) {
  Revision revision;
  revision.robot = RobotId("r");
  revision.number = 3;
  revision.document = WriteRevisionDocument(samples::SampleRevision());
  EXPECT_FALSE(json::parse(WriteShow(revision, true, {}, {})).contains("as_found"));
  const std::string text = WriteShow(revision, true, {}, {}, {}, {}, SomeFound());
  EXPECT_NE(text.find(revision.document), std::string::npos);
  EXPECT_EQ(json::parse(text)["as_found"], json::parse(WriteAsFound(SomeFound())));
  const json rows = json::parse(WriteRevisions(revision.robot, {revision}, {}, {}, {}, {{3, SummaryOf(SomeFound())}}));
  EXPECT_EQ(rows["revisions"][0]["as_found"],
            (json{{"session", std::string(64, 'a')}, {"state", "drifted"}, {"drifted", {"right"}}}));
  EXPECT_FALSE(json::parse(WriteRevisions(revision.robot, {revision}, {}))["revisions"][0].contains("as_found"));
}

}  // namespace
}  // namespace rigcal::formats
