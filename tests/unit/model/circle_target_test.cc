// Boards of circles as values: where their circles are, how they look turned, what is refused.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "server/model/boards/measure.h"
#include "server/model/sensors/target.h"

namespace rigcal {
namespace {

using testing::HasSubstr;

Target Circles(int cols, int rows, bool asymmetric = false) {
  Target target{TargetId("board"), cols, rows, 0.03, 0.0, ""};
  target.kind = asymmetric ? TargetKind::kAsymmetricCircleGrid : TargetKind::kCircleGrid;
  target.diameter_m = 0.015;
  return target;
}

std::string RefusalOf(const Target& target) {
  const Status status = Validate(target);
  return status ? std::string() : status.error().what + " | " + status.error().cure;
}

TEST(CircleTarget, CentresLieInRowsAndColumns) {
  const auto points = TargetPoints(Circles(7, 5));
  ASSERT_EQ(points.size(), 35u);
  EXPECT_LT((points[9] - Eigen::Vector3d(0.06, 0.03, 0)).norm(), 1e-12);
  EXPECT_LT((PatternSize_m(Circles(7, 5)) - Eigen::Vector2d(0.195, 0.135)).norm(), 1e-12);
  EXPECT_LT((CentreOf(Circles(7, 5)) - Eigen::Vector3d(0.09, 0.06, 0)).norm(), 1e-12);
}

// As OpenCV has them: ((2 j + i % 2) spacing, i spacing).
TEST(CircleTarget, EveryOtherRowOfAnAsymmetricOneIsShifted) {
  const auto points = TargetPoints(Circles(4, 11, true));
  ASSERT_EQ(points.size(), 44u);
  EXPECT_LT((points[3] - Eigen::Vector3d(0.18, 0, 0)).norm(), 1e-12);
  EXPECT_LT((points[4] - Eigen::Vector3d(0.03, 0.03, 0)).norm(), 1e-12);
  EXPECT_LT((points[43] - Eigen::Vector3d(0.18, 0.3, 0)).norm(), 1e-12);
  EXPECT_LT((PatternSize_m(Circles(4, 11, true)) - Eigen::Vector2d(0.225, 0.315)).norm(), 1e-12);
  EXPECT_LT((CentreOf(Circles(4, 11, true)) - Eigen::Vector3d(0.105, 0.15, 0)).norm(), 1e-12);
}

// Counted over the points themselves: how many quarter turns about the centre lay them on each other.
TEST(CircleTarget, SymmetryIsThatOfItsPoints) {
  for (const Target& target : {Circles(7, 5), Circles(6, 5), Circles(5, 5), Circles(6, 6), Circles(4, 11, true),
                               Circles(3, 7, true), Circles(4, 7, true), Circles(4, 9, true)}) {
    const auto points = TargetPoints(target);
    int alike = 0;
    for (int quarters = 0; quarters < 4; ++quarters) {
      const Eigen::Rotation2Dd turn(quarters * M_PI / 2);
      bool all = true;
      for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector2d moved = turn * (point - CentreOf(target)).head<2>() + CentreOf(target).head<2>();
        all = all && std::any_of(points.begin(), points.end(),
                                 [&](const Eigen::Vector3d& other) { return (other.head<2>() - moved).norm() < 1e-9; });
      }
      alike += all ? 1 : 0;
    }
    EXPECT_EQ(SymmetryOf(target), alike) << target.cols << " x " << target.rows;
  }
}

TEST(CircleTarget, TurnedIndexIsTheRotationAboutTheCentre) {
  for (const Target& board : {Circles(7, 5), Circles(6, 5), Circles(5, 5), Circles(6, 6), Circles(4, 11, true)}) {
    const auto points = TargetPoints(board);
    for (int turn = 0; turn < SymmetryOf(board); ++turn) {
      const Eigen::Rotation2Dd back(-2 * M_PI * turn / SymmetryOf(board));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d moved = back * (points[i] - CentreOf(board)).head<2>() + CentreOf(board).head<2>();
        const auto at = static_cast<std::size_t>(TurnedIndex(board, static_cast<int>(i), turn));
        EXPECT_LT((points[at].head<2>() - moved).norm(), 1e-12) << board.cols << " turn " << turn << " point " << i;
      }
    }
  }
}

TEST(CircleTarget, WithAnEvenNumberOfShiftedRowsIsRefused) {
  EXPECT_EQ(RefusalOf(Circles(4, 11, true)), "");
  EXPECT_THAT(RefusalOf(Circles(11, 4, true)),
              HasSubstr("an asymmetric circle grid with an even number of rows (4) looks the same turned by half"));
  EXPECT_THAT(RefusalOf(Circles(11, 4, true)), HasSubstr("were circles: [4, 11] meant?"));
  EXPECT_THAT(RefusalOf(Circles(4, 10, true)), HasSubstr("Cover a row, or use another board."));
}

TEST(CircleTarget, WithADiameterThatDoesNotFitIsRefused) {
  const auto refusal = [](double diameter_m, bool asymmetric) {
    Target target = Circles(5, 7, asymmetric);
    target.diameter_m = diameter_m;
    return RefusalOf(target);
  };
  EXPECT_EQ(refusal(0.025, false), "");
  EXPECT_THAT(refusal(0.026, false), HasSubstr("too little between two circles"));
  EXPECT_THAT(refusal(0.031, false), HasSubstr("its circles would overlap"));
  EXPECT_THAT(refusal(0.002, false), HasSubstr("too small to be measured"));
  EXPECT_THAT(refusal(0.0, false), HasSubstr("diameter_m 0.000000 does not fit spacing_m 0.030000"));
  EXPECT_FALSE(refusal(std::nan(""), false).empty());
  EXPECT_EQ(refusal(0.035, true), "") << "nearest centres are 42 mm apart";
  EXPECT_THAT(refusal(0.043, true), HasSubstr("its circles would overlap"));
  EXPECT_THAT(refusal(0.043, true), HasSubstr("half of the distance of neighbours in a row"));
}

TEST(CircleTarget, CountsAndSizesAreInRange) {
  EXPECT_THAT(RefusalOf(Circles(1, 7)), HasSubstr("1x7 circles is out of range | Count the circles, 3 to 100"));
  EXPECT_EQ(RefusalOf(Circles(3, 3)), "");
  Target target = Circles(7, 5);
  target.square_m = 30;
  EXPECT_THAT(RefusalOf(target), HasSubstr("spacing_m 30.000000 is out of range"));
  target = Circles(7, 5);
  target.dictionary = "DICT_4X4_50";
  EXPECT_THAT(RefusalOf(target), HasSubstr("a grid of circles has no dictionary"));
}

TEST(CircleTarget, NamesRoundTrip) {
  for (const char* name : {"circle_grid", "asymmetric_circle_grid"})
    EXPECT_EQ(NameOf(TargetKindOf(name).value()), name);
  EXPECT_EQ(TextOf(PatternOf(Circles(7, 5))), "circle_grid of 7 x 5 circles, 30 mm");
}

}  // namespace
}  // namespace rigcal
