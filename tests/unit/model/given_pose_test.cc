// Poses as people and CAD give them: of a rig model and of a session alike.
#include <gmock/gmock.h>

#include <limits>

#include "server/model/plausible.h"
#include "server/model/robots/rig_model.h"
#include "server/model/sessions/session.h"

namespace rigcal {
namespace {

Error Refusal(const Se3& T) { return CheckGivenPose(T).error(); }

TEST(GivenPose, IsFiniteUnitAndOnARig) {
  EXPECT_TRUE(CheckGivenPose(Se3{{1, 2, 3}, Eigen::Quaterniond(0.8, 0, 0.6, 0)}));
  EXPECT_TRUE(CheckGivenPose(Se3{{1, 2, 3}, Eigen::Quaterniond(0.8 + 5e-7, 0, 0.6, 0)}));
  EXPECT_EQ(Refusal(Se3{{1, std::numeric_limits<double>::quiet_NaN(), 3}, Eigen::Quaterniond::Identity()}).what,
            "p_m is not finite");
  EXPECT_EQ(Refusal(Se3{{1, 2, 3}, Eigen::Quaterniond(0.8, 0, 0.61, 0)}).what, "q_xyzw is not a unit quaternion");
  EXPECT_EQ(Refusal(Se3{{1, 2, 3}, Eigen::Quaterniond(std::numeric_limits<double>::quiet_NaN(), 0, 0, 0)}).what,
            "q_xyzw is not a unit quaternion");
  EXPECT_THAT(Refusal(Se3{{1, 2, 2e6}, Eigen::Quaterniond::Identity()}).what, testing::HasSubstr("p_m holds 2e+06 m"));
}

TEST(GivenPose, WhoHasItIsNamed) {
  const Se3 far{{0, 0, 2e6}, Eigen::Quaterniond::Identity()};
  Sensor sensor;
  sensor.id = SensorId("left");
  sensor.kind = SensorKind::kLidar;
  sensor.T_ref_nominal = far;
  EXPECT_THAT(Validate(sensor).error().what, testing::HasSubstr("left: nominal p_m holds 2e+06 m"));

  RigModel model;
  model.name = "mars";
  model.reference = SensorId("top");
  model.sensors = {{SensorId("top"), SensorKind::kLidar, {}, {}},
                   {SensorId("left"), SensorKind::kLidar, far, {0.01, 0.01}}};
  EXPECT_THAT(Validate(model).error().what, testing::HasSubstr("left: p_m holds 2e+06 m"));
}

}  // namespace
}  // namespace rigcal
