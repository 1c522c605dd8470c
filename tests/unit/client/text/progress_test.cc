#include "client/text/progress.h"

#include <gtest/gtest.h>

#include <sstream>

namespace rigcal::client {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(Progress, OffATerminalALineEveryFewSecondsWithoutControlCharacters) {
  std::ostringstream err;
  Progress progress(err, false, "Sending", 0);
  for (std::int64_t t = 0; t <= 12; ++t) progress.Show({t * 10'000'000, 200'000'000, "1/4 captures"}, t * kSecond_ns);
  progress.Clear();
  EXPECT_EQ(err.str(),
            "Sending 25 %  50 MB of 200 MB  1/4 captures  10 MB/s  15 s left\n"
            "Sending 50 %  100 MB of 200 MB  1/4 captures  10 MB/s  10 s left\n");
}

TEST(Progress, OnATerminalABarThatRedrawsAndGoesAway) {
  std::ostringstream err;
  Progress progress(err, true, "Sending", 0);
  progress.Show({50, 100, ""}, kSecond_ns);
  progress.Show({60, 100, ""}, kSecond_ns + 1);  // too soon
  progress.Clear();
  EXPECT_EQ(err.str(), "\r\x1b[KSending [############............] 50 %  50 B of 100 B  50 B/s  1 s left\r\x1b[K");
}

TEST(Progress, WhatWasThereBeforeIsNotOurRate) {
  std::ostringstream err;
  Progress progress(err, false, "Sending", 0);
  progress.Skip(90'000'000);
  progress.Show({95'000'000, 100'000'000, ""}, 5 * kSecond_ns);
  EXPECT_EQ(err.str(), "Sending 95 %  95 MB of 100 MB  1.0 MB/s  5 s left\n");
}

TEST(Progress, EdgesAreCountedAsEdges) {
  std::ostringstream err;
  Progress progress(err, false, "Sending", 0, Progress::Unit::kEdges);
  progress.Show({500, 2000, ""}, 5 * kSecond_ns);
  EXPECT_EQ(err.str(), "Sending 25 %  500 edges of 2000 edges  100 edges/s  15 s left\n");
}

TEST(Progress, PairsAreCountedWithoutTheirRate) {
  std::ostringstream err;
  Progress progress(err, false, "Calibrating", 0, Progress::Unit::kPairs);
  progress.Skip(2);
  progress.Show({2, 59, ""}, 5 * kSecond_ns);
  progress.Show({6, 59, ""}, 21 * kSecond_ns);
  progress.Show({59, 59, ""}, 300 * kSecond_ns);
  EXPECT_EQ(err.str(),
            "Calibrating 2 of 59 pairs\nCalibrating 6 of 59 pairs  4 min 39 s left\nCalibrating 59 of 59 pairs\n");
  std::ostringstream terminal;
  Progress bar(terminal, true, "Calibrating", 0, Progress::Unit::kPairs);
  bar.Show({5, 12, ""}, 61 * kSecond_ns);
  EXPECT_EQ(terminal.str(), "\r\x1b[KCalibrating 5 of 12 pairs [##########..............]  1 min 26 s left");
}

TEST(Progress, OfPairsItIsSaidAtOnceHowManyThereAre) {
  std::ostringstream err;
  Progress progress(err, false, "Calibrating", 0, Progress::Unit::kPairs);
  progress.Show({0, 59, ""}, kSecond_ns / 10);
  progress.Show({3, 59, ""}, kSecond_ns);
  EXPECT_EQ(err.str(), "Calibrating 0 of 59 pairs\n");
}

TEST(Progress, ALineOfItsOwnStandsAboveTheBar) {
  std::ostringstream err;
  Progress progress(err, true, "Sending", 0);
  progress.Show({0, 100, ""}, kSecond_ns);
  err.str("");
  progress.Say("No rigcald answers");
  EXPECT_EQ(err.str(), "\r\x1b[KNo rigcald answers\n");
}

TEST(DurationText, ForPeople) {
  EXPECT_EQ(DurationText(0.2), "1 s");
  EXPECT_EQ(DurationText(59.0), "59 s");
  EXPECT_EQ(DurationText(200.0), "3 min 20 s");
  EXPECT_EQ(DurationText(3720.0), "1 h 02 min");
  EXPECT_EQ(DurationText(1e300), "> 100 h");
}

}  // namespace
}  // namespace rigcal::client
