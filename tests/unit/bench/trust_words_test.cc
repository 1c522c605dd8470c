// What is read out of the service's sentences: ids of sensors and captures, and what they are accused of.
#include <gtest/gtest.h>

#include "tests/bench/trust/told_words.h"

namespace rigcal {
namespace {

std::set<std::string> Named(std::string_view text) {
  std::set<std::string> names;
  for (const SensorId& id :
       SensorsIn(text, {SensorId("left_front"), SensorId("front_left"), SensorId("left"), SensorId("back")}))
    names.insert(id.str());
  return names;
}

std::set<std::string> Captures(std::string_view text) {
  std::set<std::string> names;
  for (const CaptureId& id :
       CapturesIn(text, {CaptureId("05"), CaptureId("07"), CaptureId("12"), CaptureId("20"), CaptureId("40")}))
    names.insert(id.str());
  return names;
}

TEST(TrustWords, SensorsAreWholeWords) {
  EXPECT_EQ(Named("front_left and back do not fit the other measurements: 5 mm, 0.1 deg off."),
            (std::set<std::string>{"front_left", "back"}));
  EXPECT_EQ(Named("Check that left has moved."), (std::set<std::string>{"left"}));
  EXPECT_EQ(Named("Calibrate left_front."), (std::set<std::string>{"left_front"}));
  EXPECT_TRUE(Named("Take 20 captures.").empty());
}

TEST(TrustWords, CapturesAreNamesNotAmounts) {
  EXPECT_EQ(Captures("front_left and back: 07, 12 contradict the other captures; they are not used."),
            (std::set<std::string>{"07", "12"}));
  EXPECT_EQ(Captures("the worst captures are 05, 20."), (std::set<std::string>{"05", "20"}));
  EXPECT_EQ(Captures("back moved after capture 20 of 40 captures"), (std::set<std::string>{"20"}));
  EXPECT_EQ(Captures("moved from capture 20 on"), (std::set<std::string>{"20"}));
  EXPECT_TRUE(Captures("Take 20 captures or more, 12 mm apart, 20 to 40 captures in all.").empty());
}

TEST(TrustWords, MovedAndLensAreTold) {
  EXPECT_TRUE(SaysMoved("a and b do not fit the other measurements; one was probably moved."));
  EXPECT_TRUE(SaysMoved("a has two poses, 20 mm apart"));
  EXPECT_FALSE(SaysMoved("A bump of a by up to 8 mm would go unseen."));
  EXPECT_FALSE(SaysMoved("A sensor was remounted: push it with --remounted."));
  EXPECT_TRUE(SaysLens("the lens of a bends in a way that pinhole_radtan cannot: try pinhole_rational"));
  EXPECT_FALSE(SaysLens("Every sensor is known well enough and the edges agree with each other."));
}

}  // namespace
}  // namespace rigcal
