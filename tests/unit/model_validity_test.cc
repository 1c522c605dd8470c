#include <gtest/gtest.h>

#include "server/model/validity.h"

namespace rigcal {
namespace {

Stamp At(const char* iso) { return ParseIso(iso).value(); }

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

TEST(Validity, OnlyPassAndWarnAreUsable) {
  for (const auto& [level, usable] : {std::pair{VerdictLevel::kPass, true}, std::pair{VerdictLevel::kWarn, true},
                                      std::pair{VerdictLevel::kFail, false}, std::pair{VerdictLevel::kUnknown, false}})
    EXPECT_EQ(IsUsable({level, "", ""}), usable) << NameOf(level);
}

}  // namespace
}  // namespace rigcal
