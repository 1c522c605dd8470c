// Pages about rig models, and what the pages of robots and sessions say of epochs and parts.
#include <gmock/gmock.h>

#include "server/report/models/model_pages.h"
#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kMarkup = "<script>alert('x')</script>\"><img src=x onerror=\"y\">";

void ExpectNoMarkup(const std::string& page) {
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;"));
}

// Seven robots; right is off by 1 mm more along x on each, and on the last by far.
Population Seven() {
  Population population;
  population.rig_model = "mars";
  population.reference = SensorId("left");
  SensorPopulation right;
  right.sensor = SensorId("right");
  right.T_ref_nominal = Se3();
  right.tolerance = {0.005, 0.01};
  for (int i = 0; i < 7; ++i) {
    population.robots.push_back(RobotId("r" + std::to_string(i)));
    right.robots.push_back(population.robots.back());
    right.offsets.push_back(Vector6d::Unit(0) * (i == 6 ? 0.04 : 0.001 * i));
  }
  right.axes[0] = {0.0, 0.0015, 0.003, 0.0045, 0.04, 0.0022};
  right.outliers = {{RobotId("r6"), right.offsets.back(), 0, 1e-9}};
  population.sensors = {right};
  return population;
}

TEST(ModelPage, ShowsWhoStandsOutAndADotPerRobot) {
  const auto page = RenderRigModel(Seven(), std::nullopt);
  ASSERT_TRUE(page) << Sentence(page.error());
  EXPECT_THAT(*page, HasSubstr("7 robots with a calibration in use, told in the frame of left"));
  EXPECT_THAT(*page, HasSubstr("href=\"../../robots/r6/\""));
  EXPECT_THAT(*page, HasSubstr("37.0 mm, 0 deg"));  // from the median
  EXPECT_THAT(*page, HasSubstr("its tolerance, 5.00 mm and 0.573 deg"));
  EXPECT_THAT(*page, HasSubstr("Nobody has set this rig model"));
  EXPECT_EQ(CountOf(*page, "class=\"dots\""), 6) << "a path per axis";
  EXPECT_EQ(CountOf(*page, "class=\"dots out\""), 6);
  EXPECT_EQ(CountOf(*page, "h0"), 7 * 6) << "a dot per robot and axis";
  EXPECT_EQ(CountOf(*page, "class=\"limit\""), 12);
}

TEST(ModelPage, TheScaleHoldsEveryRobot) {
  const std::string page = RenderRigModel(Seven(), std::nullopt).value();
  EXPECT_THAT(page, HasSubstr("M326.0 "));  // r6, at the right end
  EXPECT_THAT(page, HasSubstr("M176.0 "));  // r0, where the drawing has it
}

// Where zero is the median itself, its own place is what arithmetic leaves over.
TEST(ModelPage, ArithmeticIsNoPlace) {
  Population seven = Seven();
  seven.sensors[0].axes[0].median = 9.87e-18;
  EXPECT_THAT(RenderRigModel(seven, std::nullopt).value(), AllOf(Not(HasSubstr("e-15")), HasSubstr(">0 mm<")));
}

TEST(ModelPage, FewRobotsAreTold) {
  Population few;
  few.rig_model = "mars";
  few.why_not = "2 robots of rig model mars have a calibration in use; 5 are needed to tell how they scatter.";
  few.too_few = {{SensorId("right"), 2}};
  few.left_out = {{RobotId("idle"), "no calibration of it is in use"}};
  const std::string page =
      RenderRigModel(few, RigModelVersion{"mars", 1, 3, {{0}, "Ada", "drawing 7"}, "rig_model: mars"}).value();
  EXPECT_THAT(page, HasSubstr("5 are needed"));
  EXPECT_THAT(page, HasSubstr("its pose is known on 2 robots only"));
  EXPECT_THAT(page, HasSubstr("no calibration of it is in use"));
  EXPECT_THAT(page, HasSubstr("version 3"));
  EXPECT_THAT(page, HasSubstr("rig_model: mars"));
}

TEST(ModelPage, TextsOfPeopleAreNoMarkup) {
  Population population = Seven();
  population.rig_model = kMarkup;
  ExpectNoMarkup(RenderRigModel(population, RigModelVersion{kMarkup, 1, 1, {{0}, kMarkup, kMarkup}, kMarkup}).value());
  ExpectNoMarkup(RenderRigModels({{kMarkup, 1, 2}}).value());
}

TEST(ModelList, NamesAreFoldersOfAddresses) {
  const std::string page = RenderRigModels({{"mars mapper/2", 0, 3}}).value();
  EXPECT_THAT(page, HasSubstr("href=\"mars%20mapper%2F2/\""));
  EXPECT_THAT(page, HasSubstr("not set"));
  EXPECT_EQ(PathOfRigModel("mars-mapper_2.1"), "mars-mapper_2.1");
  EXPECT_THAT(RenderRigModels({}).value(), HasSubstr("No rig model is known yet"));
}

TEST(RobotPage, ListsEpochsTheNewestFirst) {
  RobotInput input;
  input.row.robot = RobotId("r");
  input.rig_model = "mars";
  Epoch exchanged{SensorId("left"), SessionId(std::string(64, 'a')), {1'000'000'000}, EpochCause::kSerial, "A1", "B7"};
  Epoch said{SensorId("top"), {}, {2'000'000'000}, EpochCause::kPerson};
  said.word = {{2'000'000'000}, "Ada", kMarkup};
  input.epochs = {exchanged, said};
  const std::string page = RenderRobot(input, {3'000'000'000}).value();
  ExpectNoMarkup(page);
  const std::size_t by_part = page.find("the serial number of left is B7, before it was A1"),
                    by_person = page.find("an epoch of top was begun by Ada");
  ASSERT_NE(by_part, std::string::npos);
  ASSERT_NE(by_person, std::string::npos);
  EXPECT_LT(by_person, by_part);
  EXPECT_THAT(page, HasSubstr("href=\"../../models/mars/\""));
}

TEST(SessionPage, TellsPartsAndWhatItLacks) {
  SessionInput input;
  input.robot = RobotId("r");
  input.row.closed = true;
  Sensor left;
  left.id = SensorId("left"), left.serial = kMarkup, left.firmware = "2.3";
  input.manifest.header.sensors = {left};
  input.lacking = "top is in rig model mars but not here.";
  const std::string page = RenderSession(input).value();
  ExpectNoMarkup(page);
  EXPECT_THAT(page, HasSubstr("firmware <bdi>2.3</bdi>"));
  EXPECT_THAT(page, HasSubstr("top is in rig model mars but not here."));
}

}  // namespace
}  // namespace rigcal::report
