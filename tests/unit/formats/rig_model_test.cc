// Rig models as people write them: what is read, and each refusal by line and name.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/formats/rig_models/rig_model_answers.h"
#include "server/formats/rig_models/rig_model_yaml.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kMars = R"(rig_model: mars
tolerance_mm: 10
tolerance_deg: 1
sensors:
  left: {type: camera}
  right:
    type: camera
    T_ref_sensor: {p_m: [0.2, 0.1, -0.3], q_xyzw: [0.0, 0.6, 0.0, 0.8]}
  top:
    type: lidar
    T_ref_sensor: {p_m: [0.0, 0.0, 1.5]}
    tolerance_mm: 20
required_pairs: [[left, right]]
)";

std::string Refused(const std::string& text) {
  const auto model = ReadRigModel(text, "mars.yaml");
  return model ? "good" : Sentence(model.error());
}

TEST(RigModelYaml, SaysWhatAMachineHas) {
  const auto model = ReadRigModel(kMars, "mars.yaml");
  ASSERT_TRUE(model) << Sentence(model.error());
  EXPECT_EQ(model->name, "mars");
  EXPECT_EQ(model->reference, SensorId("left")) << "the first that is not drawn";
  ASSERT_EQ(model->sensors.size(), 3U);
  EXPECT_EQ(model->sensors[0].T_ref_sensor, Se3()) << "the others are drawn in it";
  EXPECT_EQ(model->sensors[1].T_ref_sensor->p_m, Eigen::Vector3d(0.2, 0.1, -0.3));
  EXPECT_NEAR(model->sensors[1].T_ref_sensor->q.y(), 0.6, 1e-12);
  EXPECT_EQ(model->sensors[1].tolerance.m, 0.01);
  EXPECT_NEAR(model->sensors[1].tolerance.rad, 0.0174532925, 1e-9);
  EXPECT_EQ(model->sensors[2].kind, SensorKind::kLidar);
  EXPECT_EQ(model->sensors[2].tolerance.m, 0.02);
  EXPECT_EQ(model->required_pairs, (std::vector<SensorPair>{{SensorId("left"), SensorId("right")}}));
}

// left turned by 90 degrees about z against right: seen from right, x of left is its -y.
TEST(RigModelYaml, APlaceCanBeSeenFromAnySensor) {
  const auto model = ReadRigModel(R"(rig_model: m
tolerance_mm: 1
tolerance_deg: 1
sensors:
  left: {type: camera}
  right: {type: camera, T_ref_sensor: {p_m: [1.0, 0.0, 0.0], q_xyzw: [0.0, 0.0, 0.7071067811865476, 0.7071067811865476]}}
)",
                                  "m.yaml");
  ASSERT_TRUE(model) << Sentence(model.error());
  const auto T = NominalPose(*model, SensorId("right"), SensorId("left"));
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->p_m.x(), 0.0, 1e-12);
  EXPECT_NEAR(T->p_m.y(), 1.0, 1e-12);
  EXPECT_FALSE(NominalPose(*model, SensorId("right"), SensorId("rear")));
}

TEST(RigModelYaml, WithoutAnyPoseNothingIsDrawn) {
  const auto model = ReadRigModel("rig_model: m\nsensors: {a: {type: camera}, b: {type: lidar}}\n", "m.yaml");
  ASSERT_TRUE(model) << Sentence(model.error());
  EXPECT_FALSE(model->sensors[0].T_ref_sensor);
  EXPECT_FALSE(NominalPose(*model, SensorId("a"), SensorId("b")));
}

TEST(RigModelYaml, WhatIsWrongIsNamed) {
  EXPECT_THAT(Refused(""), HasSubstr("mars.yaml"));
  EXPECT_THAT(Refused("rig_model: m\nsensors: {}\n"), HasSubstr("mars.yaml"));
  EXPECT_THAT(Refused("rig_model: m\nsensors: {left: {type: camra}}\n"), HasSubstr("line 2"));
  EXPECT_THAT(Refused("rig_model: m\nsensor: {left: {type: camera}}\n"), HasSubstr("did you mean \"sensors\"?"));
  const std::string drawn = "rig_model: m\nsensors:\n  a: {type: camera}\n  b: {type: camera, T_ref_sensor: {p_m: ";
  EXPECT_THAT(Refused(drawn + "[1, 0, 0]}}\n"), HasSubstr("sensor b: its pose has no tolerance"));
  EXPECT_THAT(Refused(drawn + "[1, 0]}, tolerance_mm: 1, tolerance_deg: 1}\n"), HasSubstr("line 4"));
  EXPECT_THAT(Refused(drawn + "[.nan, 0, 0]}, tolerance_mm: 1, tolerance_deg: 1}\n"), HasSubstr("line 4"));
  EXPECT_THAT(Refused(drawn + "[1, 0, 0]}, tolerance_mm: -1, tolerance_deg: 1}\n"),
              HasSubstr("tolerance_mm: must be above 0"));
  EXPECT_THAT(Refused(drawn + "[1, 0, 0], q_xyzw: [1, 1, 0, 0]}, tolerance_mm: 1, tolerance_deg: 1}\n"),
              HasSubstr("must have unit length"));
  EXPECT_THAT(Refused("rig_model: m\nsensors: {a: {type: camera, tolerance_mm: 3}}\n"),
              HasSubstr("without T_ref_sensor"));
  EXPECT_THAT(Refused("rig_model: m\nreference: b\nsensors: {a: {type: camera}}\n"),
              HasSubstr("reference \"b\" is not a sensor"));
  EXPECT_THAT(Refused("rig_model: m\nsensors: {a: {type: camera}}\nrequired_pairs: [[a, z]]\n"),
              HasSubstr("\"z\" is not a sensor of the model"));
  EXPECT_THAT(Refused("rig_model: m\nsensors: {a: {type: camera}}\nrequired_pairs: [[a, a]]\n"),
              HasSubstr("no pair with itself"));
  EXPECT_NE(Refused(std::string(40'000, '#')), "good") << "too large";
}

TEST(RigModelAnswers, HaveUnitsInTheirNames) {
  const auto model = ReadRigModel(kMars, "mars.yaml");
  ASSERT_TRUE(model);
  const json told = json::parse(WriteRigModel({{"mars", 1, 2, {{0}, "Ada", "drawing 7"}, kMars}, *model, 3}));
  EXPECT_EQ(told["model"]["sensors"][1]["tolerance_m"], 0.01);
  EXPECT_EQ(told["model"]["sensors"][1]["T_ref_sensor"]["p_m"], (json{0.2, 0.1, -0.3}));
  EXPECT_TRUE(told["model"]["sensors"][0]["tolerance_m"].is_null());
  EXPECT_EQ(told["model"]["required_pairs"][0], (json{"left", "right"}));
  EXPECT_EQ(told["set"]["version"], 2);
  EXPECT_EQ(told["set"]["text"], kMars);
  EXPECT_EQ(told["robots"], 3);
}

TEST(PopulationAnswer, TellsEachAxisInItsUnit) {
  Population population;
  population.rig_model = "mars";
  SensorPopulation left;
  left.sensor = SensorId("left");
  for (std::size_t axis = 0; axis < 6; ++axis) left.axes[axis].median = 0.001 * static_cast<double>(axis + 1);
  left.outliers = {{RobotId("r7"), Vector6d::Unit(4) * 0.1, 4, 1e-9}};
  population.sensors = {left};
  const json told = json::parse(WritePopulation(population))["sensors"][0];
  EXPECT_EQ(told["axes"][2]["median_m"], 0.003);
  EXPECT_EQ(told["axes"][3]["axis"], "rx");
  EXPECT_EQ(told["axes"][3]["median_rad"], 0.004);
  EXPECT_EQ(told["outliers"][0]["worst_axis"], "ry");
  EXPECT_EQ(told["outliers"][0]["offset"][4], 0.1);
  EXPECT_TRUE(told["T_ref_nominal"].is_null());
}

}  // namespace
}  // namespace rigcal::formats
