#include "client/check/words.h"

#include <gtest/gtest.h>

#include "client/check/capture_names.h"
#include "client/check/tilt_ring.h"

namespace rigcal::check {
namespace {

std::vector<CaptureId> Captures(std::initializer_list<const char*> names) {
  std::vector<CaptureId> captures;
  for (const char* name : names) captures.emplace_back(name);
  return captures;
}

std::vector<CaptureId> Numbered(int first, int last) {
  std::vector<CaptureId> captures;
  for (int i = first; i <= last; ++i) captures.emplace_back(std::to_string(1000 + i).substr(1));
  return captures;
}

TEST(CaptureNames, StretchesAreOfThoseThatFollowOneAnother) {
  const auto all = Numbered(1, 20);
  EXPECT_EQ(Stretches(Numbered(7, 15), all), "007 to 015");
  EXPECT_EQ(Stretches(Captures({"003", "007", "008", "009", "020"}), all), "003, 007 to 009 and 020");
  EXPECT_EQ(Stretches(Captures({"003", "004"}), all), "003 and 004");
  EXPECT_EQ(Stretches({}, all), "");
  // What was not taken at all is no gap.
  EXPECT_EQ(Stretches(Captures({"1", "9", "10"}), InOrder(Captures({"10", "9", "1"}))), "1 to 10");
}

TEST(CaptureNames, OfVeryManyTheFirstAreTold) {
  std::vector<CaptureId> every_other;
  for (int i = 1; i <= 20; i += 2) every_other.push_back(Numbered(i, i).front());
  EXPECT_EQ(Stretches(every_other, Numbered(1, 20)), "001, 003, 005, 007, 009 and 5 more");
}

TEST(CaptureNames, WhatIsMissing) {
  EXPECT_EQ(MissingText("files", Numbered(1, 6), Numbered(1, 15)),
            "files for 6 of 15 captures: 007 to 015 are missing");
  EXPECT_EQ(MissingText("poses", Numbered(1, 14), Numbered(1, 15)), "poses for 14 of 15 captures: 015 is missing");
  EXPECT_EQ(MissingText("files", Numbered(1, 15), Numbered(1, 15)), "");
}

CameraFit Tilted(std::initializer_list<Eigen::Vector2d> tilts_deg) {
  CameraFit fit;
  for (const Eigen::Vector2d& tilt : tilts_deg) {
    ViewFit view;
    view.residual_px = {Eigen::Vector2d::Zero()};
    view.tilt_rad = tilt * M_PI / 180;
    view.distance_m = 1.0 + 0.1 * static_cast<double>(fit.views.size());
    fit.views.push_back(view);
  }
  return fit;
}

TEST(TiltRing, NamesTheSidesThatAreOpen) {
  EXPECT_EQ(OpenSides(RingOf({})), "left, right, up and down");
  EXPECT_EQ(OpenSides(RingOf(Tilted({{0, 5}, {3, -4}}))), "left, right, up and down");
  // Positive: the right side is nearer, the lower side is nearer.
  const TiltRing ring = RingOf(Tilted({{20, 0}, {25, 1}, {0, 30}, {2, 16}, {-40, 0}}));
  EXPECT_EQ(OpenSides(ring), "left and up");
  EXPECT_NEAR(ring.largest_rad[0], 40 * M_PI / 180, 1e-12);
  EXPECT_NEAR(ring.largest_rad[3], 30 * M_PI / 180, 1e-12);
  EXPECT_EQ(ring.largest_rad[2], 0.0);
  EXPECT_EQ(OpenSides(RingOf(Tilted({{20, 20}, {20, 20}, {-20, -20}, {-20, -20}}))), "");
}

TEST(TiltRing, OneBoardMayCloseTwoSides) {
  EXPECT_EQ(CapturesToClose(RingOf({})), 4u);
  EXPECT_EQ(CapturesToClose(RingOf(Tilted({{20, 0}, {25, 1}, {0, 30}, {2, 16}, {-40, 0}}))), 2u);
  EXPECT_EQ(CapturesToClose(RingOf(Tilted({{20, 20}, {20, 20}, {-20, -20}, {-20, -20}}))), 0u);
}

TEST(TiltRing, DistancesAreInWidthsOfThePattern) {
  Target board{TargetId("board"), 9, 6, 0.02, 0.0, ""};
  const auto distances = DistancesOf(Tilted({{0, 0}, {0, 0}, {0, 0}}), board);
  ASSERT_TRUE(distances);
  EXPECT_NEAR(distances->near_widths, 1.0 / 0.2, 1e-9);
  EXPECT_NEAR(distances->far_widths, 1.2 / 0.2, 1e-9);
  EXPECT_FALSE(DistancesOf({}, board));
}

TEST(Words, AreEnumerated) {
  EXPECT_EQ(Enumerated({}), "");
  EXPECT_EQ(Enumerated({"left"}), "left");
  EXPECT_EQ(Enumerated({"left", "right", "up"}), "left, right and up");
  EXPECT_EQ(NamesText({"a", "b", "c", "d", "e", "f", "g", "h"}), "a, b, c, d, e, f and 2 more");
}

}  // namespace
}  // namespace rigcal::check
