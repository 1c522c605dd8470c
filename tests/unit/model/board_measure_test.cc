// What is taken as a measure of a board, and the size that follows from it.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "server/model/boards/measure.h"
#include "server/model/boards/square_size.h"

namespace rigcal {
namespace {

using testing::HasSubstr;

BoardMeasure Sample() {
  BoardMeasure measure;
  measure.serial = "B-7";
  measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
  measure.length_x_m = 0.2, measure.length_y_m = 0.1;
  measure.measured_x_m = 0.199, measure.measured_y_m = 0.1002;
  measure.sigma_m = 0.0002;
  measure.word = {{1'800'000'000'000'000'000}, "Ada", ""};
  return measure;
}

TEST(BoardMeasure, ASquareIsOffAsTheRulerIs) {
  const BoardSize size = SizeOf(Sample());
  EXPECT_NEAR(size.x_m, 0.024875, 1e-12) << "half a percent short";
  EXPECT_NEAR(size.y_m, 0.02505, 1e-12);
  EXPECT_NEAR(size.sigma_x_m, 0.000025, 1e-12) << "0.2 of 200 mm";
  EXPECT_NEAR(size.sigma_y_m, 0.00005, 1e-12) << "0.2 of 100 mm";
  EXPECT_EQ(TextOf(size), "24.875 x 25.050 mm (sigma 0.05)");
}

TEST(BoardMeasure, ARulerEndsAtAWholeHundredMillimetres) {
  EXPECT_NEAR(RulerLength_m(0.1991), 0.2, 1e-12);
  EXPECT_NEAR(RulerLength_m(0.51), 0.5, 1e-12);
  EXPECT_NEAR(RulerLength_m(0.0099), 0.1, 1e-12);
  EXPECT_NEAR(RulerLength_m(std::numeric_limits<double>::quiet_NaN()), 0.1, 1e-12);
}

TEST(BoardMeasure, RefusalsNameTheBoardAndTheUnitThatWasMeant) {
  const auto refused = [](const auto& change) {
    BoardMeasure measure = Sample();
    change(measure);
    const Status status = Validate(measure);
    return status ? std::string("taken") : Sentence(status.error());
  };
  EXPECT_EQ(refused([](auto&) {}), "taken");
  const auto x = [&](double measured_m, double length_m = 0.1) {
    return refused([&](auto& m) { m.measured_x_m = measured_m, m.length_x_m = length_m; });
  };
  EXPECT_THAT(x(0.0099), HasSubstr("looks like centimetres"));
  EXPECT_THAT(x(0.0039), HasSubstr("looks like inches"));
  EXPECT_THAT(x(0.0001), HasSubstr("looks like metres"));
  EXPECT_THAT(x(0.0001), HasSubstr("board \"B-7\": 0.1 mm measured along x is more than 5 % from the 100 mm"));
  EXPECT_THAT(x(0.106), HasSubstr("Were millimetres meant?"));
  EXPECT_EQ(x(0.1049), "taken");
  EXPECT_THAT(x(-0.1), HasSubstr("not above 0"));
  EXPECT_THAT(x(std::numeric_limits<double>::quiet_NaN()), HasSubstr("not above 0"));
  EXPECT_THAT(x(std::numeric_limits<double>::infinity()), HasSubstr("not above 0"));
  EXPECT_THAT(x(0.1, std::numeric_limits<double>::quiet_NaN()), HasSubstr("nominal length along x"));
  EXPECT_THAT(refused([](auto& m) { m.sigma_m = 0; }), HasSubstr("no rule is exact"));
  EXPECT_THAT(refused([](auto& m) { m.flatness_m = -0.001; }), HasSubstr("flatness"));
  EXPECT_THAT(refused([](auto& m) { m.next_check_at = Stamp{m.word.at.ns - 1}; }), HasSubstr("is not in the future"));
  EXPECT_THAT(refused([](auto& m) { m.next_check_at = Stamp{m.word.at.ns + 30LL * 365 * 86'400'000'000'000}; }),
              HasSubstr("20 years"));
  EXPECT_THAT(refused([](auto& m) { m.serial = "a\nb"; }), HasSubstr("is no serial"));
  EXPECT_THAT(refused([](auto& m) { m.serial = ""; }), HasSubstr("is no serial"));
  EXPECT_THAT(refused([](auto& m) { m.pattern.cols = 1000; }), HasSubstr("out of range"));
  EXPECT_THAT(refused([](auto& m) { m.pattern.square_m = 25; }), HasSubstr("a square of 25000 mm is out of range"));
}

TEST(BoardMeasure, ADayOfACheckIsNotOverBeforeItsEnd) {
  BoardMeasure measure = Sample();
  EXPECT_FALSE(IsCheckDue(measure, {std::numeric_limits<std::int64_t>::max()})) << "none was set";
  measure.next_check_at = ParseIso("2027-05-31").value();
  EXPECT_FALSE(IsCheckDue(measure, ParseIso("2027-05-31T23:59:59Z").value()));
  EXPECT_TRUE(IsCheckDue(measure, ParseIso("2027-06-01").value()));
}

TEST(BoardMeasure, PeopleCountSquaresOfACharuco) {
  const BoardPattern charuco = PatternTyped(TargetKind::kCharuco, 11, 8, 0.03);
  EXPECT_EQ(charuco.cols, 10) << "corners";
  EXPECT_EQ(TextOf(charuco), "charuco of 11 x 8 squares, 30 mm");
  EXPECT_EQ(MeasureCommand("B 7's", &charuco),
            "rigcal board measure 'B 7'\\''s' --type charuco --cols 11 --rows 8 --square-mm 30 --ruler-x-mm A "
            "--ruler-y-mm B");
  EXPECT_EQ(MeasureCommand("B-7"), "rigcal board measure B-7 --ruler-x-mm A --ruler-y-mm B");
}

TEST(SquareSize, IsTheMeanAndTheDifferenceIsInItsSigma) {
  BoardMeasure measure = Sample();
  measure.pattern.square_m = 0.03;
  measure.length_x_m = measure.length_y_m = 0.3, measure.measured_x_m = 0.299, measure.measured_y_m = 0.297,
  measure.sigma_m = 0.0003;
  const SquareSize size = SquareSizeOf(measure);
  EXPECT_NEAR(size.square_m, 0.0298, 1e-12);
  EXPECT_NEAR(size.square_sigma_m, std::hypot(0.00003 / std::sqrt(2.0), 0.0001), 1e-8);
  std::vector<Target> targets(2);
  targets[0].id = TargetId("board"), targets[0].square_m = 0.03, targets[0].marker_m = 0.0225, targets[0].cols = 9;
  targets[1].id = TargetId("wall"), targets[1].square_m = 0.1;
  TakeSizes({{TargetId("board"), size}}, targets);
  EXPECT_EQ(targets[0].square_m, size.square_m);
  EXPECT_EQ(targets[0].square_sigma_m, size.square_sigma_m);
  EXPECT_NEAR(targets[0].marker_m, 0.02235, 1e-12) << "printed with the squares";
  EXPECT_EQ(targets[0].cols, 9);
  EXPECT_EQ(targets[1].square_m, 0.1);
}

}  // namespace
}  // namespace rigcal
