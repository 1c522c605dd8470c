#include <gmock/gmock.h>

#include "server/formats/documents.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using testing::StartsWith;

// The n-th ```yaml block of docs/session-format.md: what the document shows is what works.
std::string DocumentedExample(int n) {
  const std::string page = samples::FileText(std::string(RIGCAL_SOURCE_DIR) + "/docs/session-format.md");
  std::size_t begin = 0;
  for (int i = 0; i <= n; ++i) begin = page.find("```yaml\n", begin) + 8;
  return page.substr(begin, page.find("```", begin) - begin);
}

TEST(SessionYaml, TheShortestExampleHasSensibleDefaults) {
  const auto header = ReadSessionYaml(DocumentedExample(0), "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->robot, RobotId("mapper-01"));
  EXPECT_EQ(ToIso(header->captured_at), "2026-01-31T12:00:00Z");
  EXPECT_EQ(header->reference, SensorId("left"));
  EXPECT_EQ(header->sensors.at(1).id, SensorId("right"));
  EXPECT_FALSE(header->sensors.at(0).sees || header->sensors.at(0).intrinsics || header->sensors.at(0).T_ref_nominal);
  EXPECT_EQ(header->targets.at(0).rows, 6);
  EXPECT_EQ(header->targets.at(0).square_sigma_m, 0.0);
  EXPECT_EQ(header->operator_name, "");
}

TEST(SessionYaml, TheCompleteExampleIsReadWhole) {
  const auto header = ReadSessionYaml(DocumentedExample(1), "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->rig_model, "mars-mapper");
  EXPECT_EQ(header->operator_name, "Ada");
  EXPECT_EQ(header->targets.at(0).cols, 9);
  EXPECT_EQ(header->targets.at(0).square_m, 0.025);
  EXPECT_EQ(header->targets.at(0).square_sigma_m, 5e-5);
  EXPECT_EQ(header->targets.at(0).serial, "A1");
  const Sensor& right = header->sensors.at(1);
  EXPECT_EQ(right.sees, TargetId("board"));
  EXPECT_EQ(right.intrinsics->fx_px, 535.4);
  EXPECT_EQ(right.intrinsics->cy_px, 249.9);
  EXPECT_EQ(right.intrinsics->distortion[2], 0.0013);
  EXPECT_EQ(right.intrinsics_sigma->at(4), 0.005);
  EXPECT_EQ(right.T_ref_nominal->p_m, Eigen::Vector3d(0.083, 0, 0));
  EXPECT_EQ(right.T_ref_nominal->q.w(), 1.0);
  EXPECT_EQ(header->conditions.at("temperature"), "21 C");
}

// A robot with one camera, whose fields these are.
Result<SessionHeader> WithCamera(const std::string& fields) {
  return ReadSessionYaml(
      "format: 1\nrobot: cell\ncaptured_at: 2026-01-31\ntargets:\n  board: {type: checkerboard, inner_corners: [9, 6], "
      "square_size_m: 0.025}\nsensors:\n  left: {type: camera}\n  right: {type: camera, " +
          fields + "}\n",
      "session.yaml");
}

TEST(SessionYaml, SphereModelsAreGivenOrEstimated) {
  const auto estimated = WithCamera("model: double_sphere");
  ASSERT_TRUE(estimated) << Sentence(estimated.error());
  EXPECT_EQ(estimated->sensors.at(1).camera_model, CameraModel::kDoubleSphere);
  const auto given = WithCamera(
      "intrinsics: {model: eucm, fx_px: 300, fy_px: 301, cx_px: 320, cy_px: 240, distortion: [0.6, 1.1], sigma: [1, 1, "
      "1, 1, 0.01, 0.02]}");
  ASSERT_TRUE(given) << Sentence(given.error());
  EXPECT_EQ(given->sensors.at(1).intrinsics->model, CameraModel::kEucm);
  EXPECT_EQ(given->sensors.at(1).intrinsics->distortion, (std::vector<double>{0.6, 1.1}));
  EXPECT_EQ(given->sensors.at(1).intrinsics_sigma->at(5), 0.02);
}

// Zeros would be a pinhole of one model, and no lens of the other: nothing is assumed.
TEST(SessionYaml, SphereModelsNeedTheirNumbers) {
  for (const char* model : {"eucm", "double_sphere"}) {
    const auto header =
        WithCamera("intrinsics: {model: " + std::string(model) + ", fx_px: 300, fy_px: 301, cx_px: 320, cy_px: 240}");
    ASSERT_FALSE(header) << model;
    EXPECT_THAT(header.error().what, testing::HasSubstr("line 8: sensor 'right': intrinsics")) << model;
    EXPECT_THAT(header.error().what, testing::HasSubstr("distortion")) << model;
  }
  const auto swapped =
      WithCamera("intrinsics: {model: eucm, fx_px: 300, fy_px: 301, cx_px: 320, cy_px: 240, distortion: [1.1, 0.6]}");
  ASSERT_FALSE(swapped);
  EXPECT_THAT(swapped.error().what, testing::HasSubstr("intrinsics: alpha 1.1 is not within 0 to 1"));
  EXPECT_THAT(swapped.error().cure, testing::HasSubstr("alpha beta in this order"));
}

TEST(SessionYaml, ATargetMaySayWhatCarriesIt) {
  const auto header =
      ReadSessionYaml("format: 1\nrobot: cell\ncaptured_at: 2026-01-31\n" + DocumentedExample(5), "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->targets.at(0).mounted_on, SensorId("arm"));
  const auto refused = ReadSessionYaml(
      "format: 1\nrobot: cell\ncaptured_at: 2026-01-31\ntargets:\n  wrist: {type: checkerboard, "
      "inner_corners: [9, 6], square_size_m: 0.025,\n    mounted_on: leg}\nsensors:\n  "
      "left: {type: camera}\n",
      "session.yaml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, testing::HasSubstr("session.yaml line 6: "));
  EXPECT_THAT(refused.error().what, testing::HasSubstr("mounted on \"leg\", which is not a sensor"));
}

TEST(SessionYaml, ATrackerMaySayHowFarItsClockMayBeOff) {
  const auto with = [](const std::string& type) {
    return ReadSessionYaml(
        "format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets: {b: {type: checkerboard, "
        "inner_corners: [9, 6], square_size_m: 0.025}}\nsensors:\n  left: {type: camera}\n  body: {type: " +
            type + ", clock_sigma_s: 0.002}\n",
        "session.yaml");
  };
  const auto header = with("tracker");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->sensors[1].clock_sigma_s, 0.002);
  EXPECT_FALSE(header->sensors[0].clock_sigma_s);
  EXPECT_FALSE(with("camera"));
}

TEST(SessionYaml, OrderOfSensorsIsTheFiles) {
  const auto header = ReadSessionYaml(
      "format: 1\nrobot: r\ncaptured_at: 2026-01-31\ntargets: {b: {type: checkerboard, inner_corners: [9, 6], "
      "square_size_m: 0.025}}\nsensors:\n  zed: {type: camera}\n  alpha: {type: camera}\n",
      "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->sensors[0].id, SensorId("zed"));
  EXPECT_EQ(header->reference, SensorId("zed"));
}

TEST(SessionYaml, AcceptsWhatWindowsEditorsWrite) {
  std::string text = "\xef\xbb\xbf";
  for (const char c : DocumentedExample(0)) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto header = ReadSessionYaml(text, "session.yaml");
  ASSERT_TRUE(header) << Sentence(header.error());
  EXPECT_EQ(header->robot, RobotId("mapper-01"));
}

constexpr const char* kGood = R"(format: 1
robot: mapper-01
captured_at: 2026-01-31T12:00:00Z
reference: left
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  left: {type: camera, sees: board}
  right:
    type: camera
    intrinsics: {fx_px: 535.4, fy_px: 539, cx_px: 327, cy_px: 249}
    T_ref_nominal: {p_m: [0.08, 0, 0], q_xyzw: [0, 0, 0, 1]}
conditions: {temperature: 21 C}
)";

struct BadYaml {
  std::string from, to, what;
};

class RefusedYaml : public testing::TestWithParam<BadYaml> {};

TEST_P(RefusedYaml, NamesLineAndField) {
  std::string text = kGood;
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, GetParam().from.size(), GetParam().to);
  const auto header = ReadSessionYaml(text, "session.yaml");
  ASSERT_FALSE(header) << text;
  EXPECT_THAT(header.error().what, StartsWith("session.yaml " + GetParam().what));
  EXPECT_FALSE(header.error().cure.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Fields, RefusedYaml,
    testing::Values(
        BadYaml{"robot: mapper-01", "robt: mapper-01", "line 2: unknown key \"robt\"; did you mean \"robot\"?"},
        BadYaml{"robot: mapper-01\n", "", "line 1: \"robot\" is missing"},
        BadYaml{"robot: mapper-01", "robot:", "line 2: robot: has no value"},
        BadYaml{"robot: mapper-01", "robot: [a]", "line 2: robot: must be one value"},
        BadYaml{"robot: mapper-01", "robot: a/b", "line 2: robot: robot id \"a/b\" is not a valid name"},
        BadYaml{"format: 1", "format: 2", "line 1: format: must be a whole number from 1 to 1, not \"2\""},
        BadYaml{"captured_at: 2026-01-31T12:00:00Z\n", "", "line 1: \"captured_at\" is missing"},
        BadYaml{"2026-01-31T12:00:00Z", "yesterday", "line 3: captured_at: "},
        BadYaml{"reference: left", "reference: up", "line 4: reference sensor \"up\" is not a sensor"},
        BadYaml{"sees: board", "sees: bord",
                "line 8: sensor left: it sees target \"bord\", which the session does not"},
        BadYaml{"left: {type: camera", "left: {typ: camera",
                "line 8: sensor 'left': unknown key \"typ\"; did you mean \"type\"?"},
        BadYaml{"left: {type: camera, ", "left: {", "line 8: sensor 'left': \"type\" is missing"},
        BadYaml{"left: {type: camera, sees: board}", "left: camera", "line 8: sensor 'left': must be a map of names"},
        BadYaml{"left: {type: camera", "left: {type: kamera",
                "line 8: sensor 'left': type: sensor kind \"kamera\" is not known"},
        BadYaml{"left: {type: camera", "left: {type: tracker", "line 8: sensor left: a tracker sees no target"},
        BadYaml{
            "sensors:", "skip_pairs: [[left, up]]\nsensors:", "line 7: skip_pairs: [left, up]: \"up\" is not a sensor"},
        BadYaml{"sensors:", "skip_pairs: [[left]]\nsensors:", "line 7: skip_pairs: must be two names of sensors"},
        BadYaml{"sensors:", "remounted: [up]\nsensors:", "line 7: remounted: \"up\" is not a sensor"},
        BadYaml{"sensors:", "remounted: left\nsensors:", "line 7: remounted: must be a list"},
        BadYaml{"  left:", "  top: {type: lidar, fields: [x, y]}\n  left:",
                "line 8: sensor top: fields: a point has 3 to 8 numbers, not 2"},
        BadYaml{"  left:", "  top: {type: lidar, fields: [x, y, i]}\n  left:",
                "line 8: sensor top: fields: \"z\" is missing"},
        BadYaml{"  left:", "  top: {type: lidar, fields: [x, y, z, z]}\n  left:",
                "line 8: sensor top: fields: \"z\" occurs twice"},
        BadYaml{"  left:", "  top: {type: lidar, fields: [x, y, z], point_type: half}\n  left:",
                "line 8: sensor 'top': point_type: the type \"half\" of numbers is not known"},
        BadYaml{"  left:", "  top: {type: lidar, point_type: float64}\n  left:",
                "line 8: sensor 'top': point_type: is given without fields"},
        BadYaml{"sensors:", "lidar_polish: icp\nsensors:", "line 7: lidar_polish: polish \"icp\" is not known"},
        BadYaml{"sensors:", "lidar_polish: [gicp]\nsensors:", "line 7: lidar_polish: must be one value"},
        BadYaml{"sensors:", "lidar_polish: gicp\nsensors:",
                "line 7: lidar_polish: the session has no two lidars that are calibrated with each other"},
        BadYaml{"sensors:", "lidar_polsh: gicp\nsensors:",
                "line 7: unknown key \"lidar_polsh\"; did you mean \"lidar_polish\"?"},
        BadYaml{"sensors:", "skip_pairs: left\nsensors:", "line 7: skip_pairs: must be a list"},
        BadYaml{"left: {", ".left: {", "line 8: sensor id \".left\" is not a valid name"},
        BadYaml{"fx_px: 535.4", "fx_px: 535,4", "line 11: sensor 'right': intrinsics: unknown key \"4\"; known here: "},
        BadYaml{"fx_px: 535.4", "fx_px: five",
                "line 11: sensor 'right': intrinsics: fx_px: must be a number, not \"five\""},
        BadYaml{"fx_px: 535.4", "fx_px: .nan",
                "line 11: sensor 'right': intrinsics: fx_px: must be a number, not \".nan\""},
        BadYaml{"fx_px: 535.4", "fx_px: nan",
                "line 11: sensor 'right': intrinsics: fx_px: must be a number, not \"nan\""},
        BadYaml{"fx_px: 535.4", "fx_px: 0", "line 9: sensor right: intrinsics: a focal length is not positive"},
        BadYaml{"fx_px: 535.4", "fx: 535.4", "line 11: sensor 'right': intrinsics: unknown key \"fx\"; did you mean"},
        BadYaml{"{fx_px", "{model: kb4, fx_px", "line 11: sensor 'right': intrinsics: model: is not known here"},
        BadYaml{"{fx_px", "{distortion: [1, 2], fx_px",
                "line 11: sensor 'right': intrinsics: distortion: must be a list of 5 numbers; it has 2"},
        BadYaml{"{fx_px", "{sigma: 1, fx_px", "line 11: sensor 'right': intrinsics: sigma: must be a list [...]"},
        BadYaml{"[0, 0, 0, 1]", "[0, 0, 0, 2]",
                "line 12: sensor 'right': T_ref_nominal: q_xyzw: must have unit length (it is 2.000000)"},
        BadYaml{"[0.08, 0, 0]", "[210, 0, 0]",
                "line 12: T_ref_nominal: 210 m between left and right: are these millimetres?"},
        BadYaml{"p_m", "p", "line 12: sensor 'right': T_ref_nominal: unknown key \"p\""},
        BadYaml{"checkerboard", "chessboard", "line 6: target 'board': type: is not known here"},
        BadYaml{"[9, 6]", "[9]", "line 6: target 'board': inner_corners: must be two numbers, [columns, rows]"},
        BadYaml{"[9, 6]", "[9.5, 6]", "line 6: target 'board': inner_corners: must be a whole number from 1 to 1000"},
        BadYaml{"0.025", "25", "line 6: target board: square_size_m 25.000000 is out of range"},
        BadYaml{"square_size_m", "square_size",
                "line 6: target 'board': unknown key \"square_size\"; did you mean \"square_size_m\"?"},
        BadYaml{"temperature: 21 C", "temperature: [21]", "line 13: conditions: temperature: must be one value"}));

INSTANTIATE_TEST_SUITE_P(
    Files, RefusedYaml,
    testing::Values(BadYaml{"reference: left", "robot: other", "line 4: \"robot\" stands twice (first in line 2)"},
                    BadYaml{"left: {type: camera", "left: {type: camera, type: camera",
                            "line 8: \"type\" stands twice (first in line 8)"},
                    BadYaml{"  right:", "  left:", "line 9: \"left\" stands twice (first in line 8)"},
                    BadYaml{"robot: mapper-01", "robot: &name mapper-01",
                            "line 2: anchors and aliases (& and *) are not used here"},
                    BadYaml{"robot: mapper-01", "robot: *name", "line 2: "},
                    BadYaml{"robot: mapper-01", "robot: !!str mapper-01", "line 2: tags are not used here"},
                    BadYaml{"robot: mapper-01", "? [a]\n: b", "line 2: a key must be plain text"},
                    BadYaml{"robot: mapper-01", "~: b", "line 2: a key is empty"},
                    BadYaml{"robot: mapper-01", "robot: m\xe4pper", "line 2: is not UTF-8 text"},
                    BadYaml{"robot: mapper-01", "robot: \"a\\0b\"", "line 2: text has control characters"},
                    BadYaml{"robot: mapper-01", "robot: [[[[[[[[a]]]]]]]]", "line 2: nested deeper than 8 levels"},
                    BadYaml{"robot: mapper-01", "robot: [a", "line 3: not YAML: "},
                    BadYaml{"robot: mapper-01", "robot: mapper-01\n---\nformat: 1", "line 3: a second document begins"},
                    BadYaml{"sensors:", " sensors:", "line 7: not YAML: "}));

TEST(SessionYaml, TheGoodFileIsGood) { EXPECT_TRUE(ReadSessionYaml(kGood, "session.yaml")); }

// What says that nothing is asked for is the session that does not speak of it, byte for byte.
TEST(SessionYaml, APolishIsAskedForAndOtherwiseDoesNotShow) {
  const std::string lidars =
      "format: 1\nrobot: r\ncaptured_at: 2026-01-31\nsensors: {top: {type: lidar}, rear: {type: lidar}}\n";
  const auto manifest_after = [&](const std::string& line) {
    const auto header = ReadSessionYaml(lidars + line, "session.yaml");
    EXPECT_TRUE(header) << Sentence(header.error());
    return header ? WriteManifest({*header, {}}) : "";
  };
  const std::string plain = manifest_after("");
  EXPECT_EQ(plain.find("polish"), std::string::npos);
  EXPECT_EQ(manifest_after("lidar_polish: none\n"), plain);
  std::string polished = manifest_after("lidar_polish: gicp\n");
  const std::string member = "\"lidar_polish\":\"gicp\",";
  ASSERT_NE(polished.find(member), std::string::npos) << polished;
  EXPECT_EQ(polished.erase(polished.find(member), member.size()), plain);
}

TEST(SessionYaml, HostileFilesAreRefusedNotRun) {
  std::string wide = "a:\n";
  for (int i = 0; i < 5000; ++i) wide += "  k" + std::to_string(i) + ": 1\n";
  const std::vector<std::string> files = {"",
                                          "\n",
                                          "just text",
                                          "- 1\n- 2\n",
                                          std::string(1'000'000, '['),
                                          std::string(1'000'000, '{'),
                                          std::string(500'000, '-'),
                                          std::string(2'000'000, 'x'),
                                          "a: &a [*a, *a]",
                                          "%YAML 9.9\n---\na: 1",
                                          std::string("a\0b: 1", 6),
                                          "a: |\n" + std::string(900'000, ' ') + "x",
                                          wide,
                                          "format: 1\nrobot: r\ncaptured_at: 2026-01-31\nsensors:\n  " +
                                              std::string(900, 's') + ": {type: camera, what: 1}\n"};
  for (const std::string& file : files) {
    const auto header = ReadSessionYaml(file, "session.yaml");
    ASSERT_FALSE(header) << file.substr(0, 40);
    EXPECT_THAT(header.error().what, StartsWith("session.yaml"));
    EXPECT_LT(header.error().what.size(), 500u);
  }
}

TEST(SessionYaml, NoTruncationCrashes) {
  const std::string text = DocumentedExample(1);
  for (std::size_t length = 0; length < text.size(); ++length)
    (void)ReadSessionYaml(std::string_view(text).substr(0, length), "session.yaml");
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string broken = text;
    broken[i] = "{}[]:&*!|>%@`\"'#-?, \n\t"[i % 23];
    (void)ReadSessionYaml(broken, "session.yaml");
  }
}

}  // namespace
}  // namespace rigcal::formats
