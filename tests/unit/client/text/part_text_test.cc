// What `show` and `lookup` print of a pose of which a direction was not measured, and how they end.
#include "client/text/part_text.h"

#include <gmock/gmock.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kAxes =
    R"([{"name":"forward","direction":[1,0,0],"position_m":0.0832,"sigma_m":0.00041},)"
    R"({"name":"sideways","direction":[0,1,0],"position_m":-0.00092,"sigma_m":0.00033},)"
    R"({"name":"height","direction":[0,0,1],"position_m":null,"sigma_m":null},)"
    R"({"name":"roll","direction":[1,0,0],"sigma_rad":0.0001},{"name":"pitch","direction":[0,1,0],"sigma_rad":0.0002},)"
    R"({"name":"yaw","direction":[0,0,1],"sigma_rad":0.0003}])";
const std::string kHeld = R"({"p_m":[0.0832,-0.00092,0.777],"q_xyzw":[0,0,0,1]})";
const std::string kOpen = R"("known":false,"unobservable_basis":[[0,0,1,0,0,0]],)";

std::string LookupAlong(const std::string& level, const std::string& axes = kAxes) {
  return R"({"T_a_b":null,"covariance":null,"sigma_m":null,"sigma_rad":null,)" + kOpen +
         R"("measured_part":{"T_a_b":)" + kHeld + R"(,"axes":)" + axes +
         R"(},"robot_axes":{"forward":[1,0,0],"left":[0,1,0],"up":[0,0,1]},"frame_a":"base",)" +
         R"("frame_b":"lidar","revision":3,"robot":"r","verdict":{"level":")" + level +
         R"(","what_to_do":"Nothing","why":"all agree"}})";
}

TEST(PartText, LookupTellsWhatWasMeasuredAndEndsAsUnknown) {
  FakeServer server("r", Always(LookupAlong("pass")));
  const Ran ran = Rigcal({"lookup", "r", "base", "lidar"});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_THAT(ran.out,
              HasSubstr("The height of lidar in base was not measured; the rest is good to 0.41 mm and 0.017 deg.\n"));
  EXPECT_THAT(ran.out, HasSubstr("rpy deg    0.0000 0.0000 0.0000"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("  forward +1.000 0.000 0.000 +83.20 +0.410 mm\n"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("  height +0.000 0.000 1.000 +- +not measured\n"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("  yaw +0.000 0.000 1.000 +0.0172 deg\n"));
  EXPECT_THAT(ran.out, Not(HasSubstr("777")));  // what was held is no result
  EXPECT_THAT(ran.out, HasSubstr("verdict  pass"));
  const Ran json = Rigcal({"lookup", "r", "base", "lidar", "--json"});
  EXPECT_EQ(json.code, 6);
  EXPECT_EQ(json.out, LookupAlong("pass") + "\n");
}

TEST(PartText, AVerdictThatFailsStaysWorse) {
  FakeServer server("r", Always(LookupAlong("fail")));
  EXPECT_EQ(Rigcal({"lookup", "r", "base", "lidar"}).code, 1);
}

TEST(PartText, ShowTellsEachAxisOfASensorInPart) {
  const std::string known =
      R"({"id":"base","known":true,"T_ref_sensor":{"p_m":[0,0,0],"q_xyzw":[0,0,0,1]},"sigma_m":[0,0,0],"sigma_rad":[0,0,0]})";
  const std::string part = R"({"id":"lidar","T_ref_sensor":null,)" + kOpen + R"("measured_part":{"T_ref_sensor":)" +
                           kHeld + R"(,"axes":)" + kAxes + "}}";
  const std::string lost = R"({"id":"top","known":false,"T_ref_sensor":null})";
  const std::string sensors = R"(,"reference":"base","verdict":{"level":"unknown"},"sensors":[)" + known + "," + part +
                              "," + lost + R"(],"edges":[]}})";
  const std::string axes = R"("robot_axes":{"forward":[1,0,0],"left":[0,1,0],"up":[0,0,1]})";
  FakeServer server("r", Always(R"({"robot":"r","revision":3,"document":{)" + axes + sensors));
  const Ran ran = Rigcal({"show", "r"});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_THAT(ran.out, testing::ContainsRegex("lidar +height not measured +0.000 0.000 0.000\n"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("top +unknown\n"));
  EXPECT_THAT(ran.out,
              HasSubstr("\nThe height of lidar was not measured; the rest is good to 0.41 mm and 0.017 deg.\n"));
  EXPECT_THAT(ran.out, testing::ContainsRegex("  sideways +0.000 1.000 0.000 +-0.92 +0.330 mm\n"));
  EXPECT_THAT(ran.out, Not(HasSubstr("777")));
}

Document Told(const std::string& axes, const std::string& open) {
  return Document::Parse(
             R"({"known":false,"unobservable_basis":)" + open + R"(,"measured_part":{"axes":)" + axes + "}}", "sensor")
      .value();
}

TEST(PartText, ADirectionWithoutANameIsCountedAndStandsInTheTableOnly) {
  const Document told = Told(R"([{"name":null,"direction":[0.9,-0.44,0],"position_m":null,"sigma_m":null},)"
                             R"({"name":"yaw","direction":[0,0,1],"sigma_rad":0.0003}])",
                             "[[0.9,-0.44,0,0,0,0]]");
  EXPECT_EQ(OpenText(told), "one direction not measured");
  EXPECT_EQ(PartSentence(told, "lidar"), "One direction of lidar was not measured; the rest is good to 0.017 deg.");
  std::ostringstream named, unnamed;
  PrintPart(told, Document::Parse(R"({"forward":[1,0,0],"left":[0,1,0],"up":[0,0,1]})", "axes").value(), named);
  EXPECT_THAT(named.str(), HasSubstr("(0.90 forward, -0.44 sideways)"));
  PrintPart(told, {}, unnamed);
  EXPECT_THAT(unnamed.str(), HasSubstr("(0.90 x, -0.44 y)"));
}

TEST(PartText, SeveralAxesAreListedAndATurnThatIsOpenHasNoAngles) {
  const Document told = Told(R"([{"name":"forward","direction":[1,0,0],"position_m":null,"sigma_m":null},)"
                             R"({"name":"height","direction":[0,0,1],"position_m":1,"sigma_m":0.012},)"
                             R"({"name":"yaw","direction":[0,0,1],"sigma_rad":null}])",
                             "[[0.3,0,0,0,0,1]]");
  EXPECT_EQ(PartSentence(told, "lidar"),
            "The forward position and the yaw of lidar were not measured; the rest is good to 12 mm.");
  EXPECT_EQ(OpenText(told), "forward and yaw not measured");
  EXPECT_EQ(PartRpyText(told, 3), "-");
}

TEST(PartText, WithoutTheRobotsAxesTheFrameIsNamed) {
  std::ostringstream out;
  PrintParts(Document::Parse(
                 R"({"reference":"base","sensors":[{"id":"lidar",)" + kOpen +
                     R"("measured_part":{"axes":[{"name":"z","direction":[0,0,1],"position_m":null,"sigma_m":null},)"
                     R"({"name":"rx","direction":[1,0,0],"sigma_rad":0.0003}]}}]})",
                 "revision")
                 .value(),
             out);
  EXPECT_THAT(
      out.str(),
      HasSubstr(
          "The position along z of lidar in the frame of base was not measured; the rest is good to 0.017 deg.\n"));
}

TEST(PartText, AnOlderServersSensorIsUnknownAsBefore) {
  EXPECT_FALSE(IsInPart(Document::Parse(R"({"known":false,"unobservable_basis":[[0,0,1,0,0,0]]})", "sensor").value()));
  EXPECT_FALSE(IsInPart({}));
}

}  // namespace
}  // namespace rigcal::client
