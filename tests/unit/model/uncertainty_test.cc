#include "server/model/edges/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/model/values.h"

namespace rigcal {
namespace {

Matrix6d Diagonal(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d diagonal;
  diagonal << x, y, z, rx, ry, rz;
  return diagonal.asDiagonal();
}
Uncertainty Given(const Matrix6d& Omega) { return FromInformation(Omega, UncertaintySource::kGiven, 0); }

bool WhatContains(const Status& status, const std::string& text) {
  return !status && status.error().what.find(text) != std::string::npos;
}

TEST(UncertaintySource, NamesRoundTrip) {
  for (const char* name : {"jackknife", "model", "given", "assumed"})
    EXPECT_EQ(NameOf(UncertaintySourceOf(name).value()), name);
  EXPECT_NE(UncertaintySourceOf("guess").error().what.find("guess"), std::string::npos);
}

// 2 mm on y alone, 0.5 mrad on rz alone.
TEST(Uncertainty, SigmaIsFoundOnItsAxis) {
  const auto uncertainty =
      FromCovariance(Diagonal(1e-6, 4e-6, 1e-6, 1e-8, 1e-8, 2.5e-7), UncertaintySource::kModel, 3).value();
  EXPECT_NEAR(SigmaOf(uncertainty, tangent::kY).value, 2e-3, 1e-12);
  EXPECT_NEAR(SigmaOf(uncertainty, tangent::kRz).value, 5e-4, 1e-12);
  EXPECT_NEAR(uncertainty.Omega(tangent::kY, tangent::kY), 2.5e5, 1e-6);
  EXPECT_EQ(uncertainty.rank, 6);
  EXPECT_EQ(uncertainty.dof, 3);
  EXPECT_TRUE(Validate(uncertainty).has_value());
}

TEST(Uncertainty, AnUnobservableAxisHasNoNumber) {
  const Uncertainty uncertainty = Given(Diagonal(1e4, 1e4, 0, 1e6, 1e6, 1e6));
  EXPECT_EQ(uncertainty.rank, 5);
  EXPECT_FALSE(SigmaOf(uncertainty, tangent::kZ).known);
  EXPECT_TRUE(SigmaOf(uncertainty, tangent::kX).known);
  EXPECT_NEAR(SigmaOf(uncertainty, tangent::kX).value, 1e-2, 1e-12);
  EXPECT_FALSE(SigmaOf(uncertainty, 6).known);
  EXPECT_FALSE(SigmaOf(uncertainty, -1).known);
}

// Only x + y is known: neither axis has a number of its own.
TEST(Uncertainty, AnObliqueUnobservableDirectionTakesBothAxes) {
  Matrix6d Omega = Diagonal(1, 1, 1, 1, 1, 1);
  Omega(0, 1) = Omega(1, 0) = 1;
  const Uncertainty uncertainty = Given(Omega);
  EXPECT_EQ(uncertainty.rank, 5);
  EXPECT_FALSE(SigmaOf(uncertainty, tangent::kX).known);
  EXPECT_FALSE(SigmaOf(uncertainty, tangent::kY).known);
  EXPECT_TRUE(SigmaOf(uncertainty, tangent::kZ).known);
}

TEST(Uncertainty, ACovarianceMustBeInvertible) {
  const auto refuse = [](const Matrix6d& C) { return !FromCovariance(C, UncertaintySource::kGiven, 0).has_value(); };
  EXPECT_TRUE(refuse(Matrix6d::Zero()));
  EXPECT_TRUE(refuse(Diagonal(1, 1, 0, 1, 1, 1)));
  EXPECT_TRUE(refuse(Diagonal(1, 1, -1, 1, 1, 1)));
  EXPECT_TRUE(refuse(Diagonal(1, 1, kNaN, 1, 1, 1)));
  EXPECT_TRUE(refuse(1e-250 * Matrix6d::Identity()));
  EXPECT_FALSE(refuse(1e-12 * Matrix6d::Identity()));
}

TEST(ValidateUncertainty, NamesTheField) {
  Uncertainty good = Given(Matrix6d::Identity());
  ASSERT_TRUE(Validate(good).has_value());
  Uncertainty bad = good;
  bad.Omega(0, 0) = -1;
  EXPECT_TRUE(WhatContains(Validate(bad), "information"));
  bad = good;
  bad.Omega(4, 4) = kNaN;
  EXPECT_TRUE(WhatContains(Validate(bad), "not finite"));
  bad = good;
  bad.rank = 5;
  EXPECT_TRUE(WhatContains(Validate(bad), "rank: 5 is given"));
  bad = good;
  bad.dof = -1;
  EXPECT_TRUE(WhatContains(Validate(bad), "dof"));
  bad.dof = std::numeric_limits<int>::max();
  EXPECT_TRUE(WhatContains(Validate(bad), "dof"));
  bad = good;
  bad.jackknife_ratio = 0.5;
  EXPECT_TRUE(WhatContains(Validate(bad), "the source is"));
  bad.jackknife_ratio = kNaN;
  EXPECT_TRUE(WhatContains(Validate(bad), "jackknife_ratio"));
}

TEST(ValidateUncertainty, LooksAtBlocksAndContributions) {
  Uncertainty jackknife = Given(Matrix6d::Identity());
  jackknife.source = UncertaintySource::kJackknife;
  EXPECT_TRUE(WhatContains(Validate(jackknife), "0 block vectors"));
  jackknife.blocks = {{"001", Vector6d::Zero()}, {"002", Vector6d::Zero()}};
  EXPECT_TRUE(Validate(jackknife).has_value());
  jackknife.blocks[1].d(3) = kNaN;
  EXPECT_TRUE(WhatContains(Validate(jackknife), "\"002\" is not finite"));
  jackknife.blocks[1] = {"", Vector6d::Zero()};
  EXPECT_TRUE(WhatContains(Validate(jackknife), "block id"));

  Uncertainty parts = Given(Matrix6d::Identity());
  parts.contributions = {{"board size", -Matrix6d::Identity()}};
  EXPECT_TRUE(WhatContains(Validate(parts), "board size"));
}

}  // namespace
}  // namespace rigcal
