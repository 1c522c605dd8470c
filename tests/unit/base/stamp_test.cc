#include "server/base/stamp.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// Seconds from `date -u -d ... +%s`.
TEST(Stamp, KnownInstants) {
  EXPECT_EQ(ToIso(Stamp{0}), "1970-01-01T00:00:00Z");
  EXPECT_EQ(ToIso(Stamp{1'769'860'800 * kSecond_ns}), "2026-01-31T12:00:00Z");
  EXPECT_EQ(ParseIso("2026-01-31T12:00:00Z").value().ns, 1'769'860'800 * kSecond_ns);
  EXPECT_EQ(ParseIso("2024-02-29").value().ns, 1'709'164'800 * kSecond_ns);
  EXPECT_EQ(ParseIso("2200-12-31T23:59:59").value().ns, 7'289'654'399 * kSecond_ns);
}

TEST(Stamp, ZonesAreSubtracted) {
  const std::int64_t noon_ns = ParseIso("2026-01-31T12:00:00Z").value().ns;
  EXPECT_EQ(ParseIso("2026-01-31T13:00:00+01:00").value().ns, noon_ns);
  EXPECT_EQ(ParseIso("2026-01-31T06:30:00-05:30").value().ns, noon_ns);
}

TEST(Stamp, FractionsAreKeptToTheNanosecond) {
  EXPECT_EQ(ParseIso("1970-01-01T00:00:01.5Z").value().ns, 1'500'000'000);
  EXPECT_EQ(ParseIso("1970-01-01T00:00:00.000000001").value().ns, 1);
  EXPECT_EQ(ToIso(Stamp{1'500'000'000}), "1970-01-01T00:00:01.5Z");
  EXPECT_EQ(ToIso(Stamp{1}), "1970-01-01T00:00:00.000000001Z");
  EXPECT_EQ(ToIso(Stamp{-1}), "1969-12-31T23:59:59.999999999Z");
}

TEST(Stamp, TextRoundTrips) {
  for (std::int64_t ns : {0LL, 1LL, 1'709'164'800'123'456'789LL, 7'289'654'399'999'999'999LL})
    EXPECT_EQ(ParseIso(ToIso(Stamp{ns})).value().ns, ns);
}

TEST(Stamp, RefusesWhatIsNoTime) {
  for (const char* text : {"",
                           "2026",
                           "2026-1-31",
                           "2026-13-01",
                           "2026-00-01",
                           "2026-02-30",
                           "2025-02-29",
                           "1969-12-31",
                           "2201-01-01",
                           "2026-01-31T",
                           "2026-01-31 12:00:00",
                           "2026-01-31T12:00",
                           "2026-01-31T24:00:00",
                           "2026-01-31T12:60:00",
                           "2026-01-31T12:00:60",
                           "2026-01-31T12:00:00.",
                           "2026-01-31T12:00:00.1234567890",
                           "2026-01-31T12:00:00ZZ",
                           "2026-01-31T12:00:00+1",
                           "2026-01-31T12:00:00+01:00Z",
                           "+026-01-31",
                           "1970-01-01T00:00:00+01:00"})
    EXPECT_FALSE(ParseIso(text).has_value()) << text;
  EXPECT_NE(ParseIso("yesterday").error().what.find("yesterday"), std::string::npos);
}

TEST(Duration, KnowsDaysHoursMinutesSeconds) {
  EXPECT_EQ(ParseDuration("90d").value(), 90 * 86400 * kSecond_ns);
  EXPECT_EQ(ParseDuration("12h").value(), 12 * 3600 * kSecond_ns);
  EXPECT_EQ(ParseDuration("30m").value(), 1800 * kSecond_ns);
  EXPECT_EQ(ParseDuration("45s").value(), 45 * kSecond_ns);
  EXPECT_EQ(ParseDuration("36500d").value(), 36500LL * 86400 * kSecond_ns);
}

TEST(Duration, RefusesTheRest) {
  for (const char* text : {"", "d", "90", "-1d", "1.5h", "1w", "90 d", "90dd", "36501d", "99999999999999999999s"})
    EXPECT_FALSE(ParseDuration(text).has_value()) << text;
}

TEST(AgeText, OneUnitThatAPersonReads) {
  constexpr std::int64_t kDay_s = 86400;
  const std::pair<std::int64_t, const char*> cases[] = {{0, "0 s"},
                                                        {-5, "0 s"},
                                                        {59, "59 s"},
                                                        {303, "5 min"},
                                                        {3599, "59 min"},
                                                        {7200, "2 h"},
                                                        {2 * kDay_s - 1, "47 h"},
                                                        {3 * kDay_s + 4 * 3600 + 59, "3 days"},
                                                        {100 * kDay_s - 1, "99 days"},
                                                        {100 * kDay_s, "3 months"},
                                                        {629 * kDay_s, "20 months"},
                                                        {2151 * kDay_s, "5.9 years"},
                                                        {36500 * kDay_s, "99.9 years"}};
  for (const auto& [age_s, text] : cases) EXPECT_EQ(AgeText(age_s * kSecond_ns), text) << age_s;
}

TEST(SystemClock, LiesInThisCentury) {
  EXPECT_GT(SystemClock().Now(), ParseIso("2024-01-01").value());
  EXPECT_LT(SystemClock().Now(), ParseIso("2200-01-01").value());
}

}  // namespace
}  // namespace rigcal
