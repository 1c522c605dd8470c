#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "server/model/edges/edge.h"
#include "tests/unit/model/values.h"

namespace rigcal {
namespace {

using ::testing::HasSubstr;
Edge GoodEdge() {
  Edge edge;
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("right");
  edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.method = "given";
  edge.state = EdgeState::kGood;
  return edge;
}

// The refusal of a good edge after `change`; empty if it is still good.
std::string EdgeRefusalAfter(const std::function<void(Edge&)>& change) {
  Edge edge = GoodEdge();
  change(edge);
  const Status status = Validate(edge);
  if (status) return "";
  EXPECT_FALSE(status.error().cure.empty());
  return status.error().what;
}

TEST(ValidateEdge, AcceptsAGoodEdge) {
  EXPECT_EQ(EdgeRefusalAfter([](Edge&) {}), "");
  EXPECT_EQ(EdgeRefusalAfter([](Edge& e) { e.T_a_b.q.w() = 1.0 + 5e-7; }), "");
}

TEST(ValidateEdge, NamesEdgeAndField) {
  EXPECT_EQ(EdgeRefusalAfter([](Edge& e) { e.T_a_b.p_m.y() = kNaN; }), "edge left - right: p_m is not finite");
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.T_a_b.q.x() = kNaN; }), HasSubstr("left - right: q_xyzw is not finite"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.T_a_b.q.w() = 1.0 + 2e-6; }), HasSubstr("q_xyzw is not a unit"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.T_a_b.q.coeffs().setZero(); }), HasSubstr("q_xyzw is not a unit"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.uncertainty.Omega(0, 0) = -1; }),
              HasSubstr("left - right: information"));
  EXPECT_THAT(
      EdgeRefusalAfter([](Edge& e) { e.uncertainty = FromInformation(Matrix6d::Zero(), e.uncertainty.source, 0); }),
      HasSubstr("information is zero"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.figures["rms_px"] = kNaN; }), HasSubstr("figure rms_px"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) {
                e.captures.push_back({CaptureId("003"), kNaN, true, ""});
              }),
              HasSubstr("capture 003"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.epoch = 0; }), HasSubstr("epoch"));
}

TEST(ValidateEdge, RefusesNumbersThatNoRigHasWhereTheyWerePushed) {
  const auto far = [](Edge& e) { e.T_a_b.p_m.z() = -1.1e6; };
  const auto sure = [](Edge& e) {
    e.uncertainty = FromInformation(1.1e18 * Matrix6d::Identity(), e.uncertainty.source, 0);
  };
  EXPECT_THAT(EdgeRefusalAfter(far), HasSubstr("left - right: p_m holds 1.1e+06 m"));
  EXPECT_THAT(EdgeRefusalAfter(sure), HasSubstr("left - right: information holds 1.1e+18"));
  EXPECT_EQ(EdgeRefusalAfter([](Edge& e) { e.T_a_b.p_m.setConstant(1e6); }), "");
  EXPECT_EQ(EdgeRefusalAfter([&](Edge& e) {
              sure(e);
              e.session = SessionId(std::string(64, 'a'));  // of our own making
            }),
            "");
}

TEST(ValidateEdge, ChecksNames) {
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.frame_b = e.frame_a; }), HasSubstr("the same"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.frame_a = SensorId(); }), HasSubstr("sensor id"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.frame_a = SensorId("../etc"); }), HasSubstr("sensor id \"../etc\""));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.robot = RobotId(); }), HasSubstr("robot id"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.method = "<script>"; }), HasSubstr("method"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.id = EdgeId("12"); }), HasSubstr("edge id"));
  EXPECT_THAT(EdgeRefusalAfter([](Edge& e) { e.session = SessionId("12"); }), HasSubstr("session id"));
}

TEST(ValidateEdge, AFailedEdgeNeedsItsDiagnosisButNoPose) {
  const auto fail = [](Edge& e) {
    e.state = EdgeState::kFailed;
    e.uncertainty = {};
    e.T_a_b.q.coeffs().setZero();
  };
  EXPECT_THAT(EdgeRefusalAfter(fail), HasSubstr("without a diagnosis"));
  EXPECT_EQ(EdgeRefusalAfter([&](Edge& e) {
              fail(e);
              e.diagnoses = {{"too_few_captures", "3 captures", "Take at least 8."}};
            }),
            "");
}

TEST(VerdictLevel, NamesRoundTrip) {
  for (VerdictLevel level : {VerdictLevel::kUnknown, VerdictLevel::kPass, VerdictLevel::kWarn, VerdictLevel::kFail})
    EXPECT_EQ(VerdictLevelOf(NameOf(level)), level);
  EXPECT_EQ(VerdictLevelOf("splendid"), VerdictLevel::kUnknown);
}

}  // namespace
}  // namespace rigcal
