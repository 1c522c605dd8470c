#include "server/model/approval/validity.h"

#include <gtest/gtest.h>

#include "tests/unit/model/values.h"

namespace rigcal {
namespace {

TEST(Validity, ADayIsThatOfUtc) {
  EXPECT_EQ(DayText(Stamp{0}), "1 Jan 1970");
  EXPECT_EQ(DayText(At("2027-02-20T23:59:59Z")), "20 Feb 2027");
  EXPECT_EQ(DayText(At("2026-12-31T23:30:00-01:00")), "1 Jan 2027");
}

TEST(Validity, ValidForNinetyDaysAndOverdueAfterThem) {
  const Stamp measured = At("2026-11-22T08:00:00Z"), until = At("2027-02-20T08:00:00Z");
  EXPECT_EQ(ValidUntil(Validity{measured}), until);
  EXPECT_EQ(ValidUntil(Validity{measured, false, {}, false, "", 30LL * 86'400'000'000'000}),
            At("2026-12-22T08:00:00Z"));
  EXPECT_FALSE(IsOverdue(measured, kDefaultMaxAge_ns, until));
  EXPECT_TRUE(IsOverdue(measured, kDefaultMaxAge_ns, Stamp{until.ns + 1}));
  EXPECT_TRUE(IsOverdue(std::nullopt, kDefaultMaxAge_ns, until));
  EXPECT_EQ(ValidUntil(Validity{}), std::nullopt);
}

// Half a year ago all of them, yesterday two.
TEST(Validity, IsAsOldAsWhatTiesItsSensors) {
  const SensorId ref("ref"), left("left"), right("right"), top("top");
  const Stamp june = At("2026-06-01T00:00:00Z"), july = At("2026-07-01T00:00:00Z"),
              yesterday = At("2026-11-20T00:00:00Z");
  std::vector<DatedTie> ties = {{ref, left, june}, {ref, right, june}, {ref, top, june}};
  const std::set<SensorId> all = {ref, left, right, top};
  EXPECT_EQ(MeasuredThroughout({}, all), std::nullopt);
  EXPECT_EQ(MeasuredThroughout(ties, all), june);
  ties.push_back({left, right, yesterday});
  EXPECT_EQ(MeasuredThroughout(ties, all), june);
  EXPECT_EQ(MeasuredThroughout(ties, {left, right}), yesterday);
  ties.insert(ties.begin(), {top, left, july});
  ties.push_back({ref, right, yesterday});
  EXPECT_EQ(MeasuredThroughout(ties, all), july) << "top by left, left by right, right by ref";
  EXPECT_EQ(MeasuredThroughout({{left, right, july}}, {left, right, top}), july) << "top is tied to nothing";
}

TEST(Validity, OfAFailTheCalibrationThatIsKeptIsInDoubtToo) {
  UsableRevision kept{4, At("2026-11-27T08:00:00Z"), At("2026-03-12T08:00:00Z")};
  EXPECT_EQ(KeepText(VerdictLevel::kUnknown, kept),
            "Keep using revision 4, measured 12 Mar 2026, until 10 Jun 2026, but for what is not verified here.");
  EXPECT_EQ(KeepText(VerdictLevel::kFail, kept),
            "Robots that listen still have revision 4, measured 12 Mar 2026: do not rely on it, either, until this is "
            "cleared up.");
  kept.calibrated_at.reset();
  EXPECT_EQ(KeepText(VerdictLevel::kUnknown, kept),
            "Keep using revision 4 meanwhile, but for what is not verified here.");
  EXPECT_EQ(KeepText(VerdictLevel::kFail, std::nullopt), "There is no earlier calibration to fall back to.");
}

TEST(Validity, OnlyPassAndWarnAreUsable) {
  for (const auto& [level, usable] : {std::pair{VerdictLevel::kPass, true}, std::pair{VerdictLevel::kWarn, true},
                                      std::pair{VerdictLevel::kFail, false}, std::pair{VerdictLevel::kUnknown, false}})
    EXPECT_EQ(IsUsable({level, "", ""}), usable) << NameOf(level);
}

}  // namespace
}  // namespace rigcal
