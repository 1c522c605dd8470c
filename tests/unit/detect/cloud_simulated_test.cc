#include <gtest/gtest.h>

#include <algorithm>

#include "server/detect/clouds/cloud_board.h"
#include "tests/unit/simulated_scan.h"

namespace rigcal::detect {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

const Vector2d kPlate_m(0.85, 0.61);
constexpr double kDegree = M_PI / 180;

Target Board() {
  Target board{TargetId("board"), 7, 5, 0.095, 0.0, ""};
  board.plate_m = kPlate_m;
  return board;
}

// A hall with a floor, and a person-like box beside the plate.
std::vector<Panel> Room(const Panel& plate) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<Panel> panels = {{{0, 0, -1.2}, x, y, {30, 30}},
                               {{0, -12, 0}, x, z, {30, 5}},
                               {{0, 12, 0}, x, z, {30, 5}},
                               {{-15, 0, 0}, y, z, {12, 5}},
                               {{20, 0, 0}, y, z, {12, 5}}};
  const Vector3d away = plate.centre_m.normalized(), side = z.cross(away).normalized();
  for (const Panel& panel : BoxAt(plate.centre_m + 0.75 * side + 0.1 * away - z * 0.2, {0.3, 0.45, 1.7}))
    panels.push_back(panel);
  panels.push_back(plate);
  return panels;
}

const PlanePatch* Match(const CloudView& view, const Panel& plate, double within_m) {
  for (const PlanePatch& patch : view.candidates)
    if ((patch.centre_m - plate.centre_m).norm() < within_m) return &patch;
  return nullptr;
}

double Angle_deg(const PlanePatch& patch, const Panel& plate) {
  return std::acos(std::min(1.0, std::abs(patch.normal.dot(plate.Normal())))) / kDegree;
}

// How far the points reach beyond the true plate; they are where their beams pierce it.
double Beyond_m(const PlanePatch& patch, const Panel& plate) {
  double beyond_m = -1;
  for (const Eigen::Vector3f& point : patch.points_m) {
    const Vector3d p = point.cast<double>(), n = plate.Normal();
    const Vector3d off = p * (n.dot(plate.centre_m) / n.dot(p)) - plate.centre_m;
    beyond_m = std::max(
        {beyond_m, std::abs(plate.u.dot(off)) - plate.half_m.x(), std::abs(plate.v.dot(off)) - plate.half_m.y()});
  }
  return beyond_m;
}

struct Case {
  int rings;
  double distance_m, yaw_deg, pitch_deg, roll_deg;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.rings << " rings, " << c.distance_m << " m, yaw " << c.yaw_deg << " pitch " << c.pitch_deg << " roll "
       << c.roll_deg;
}

Beams BeamsOf(int rings) { return rings == 16 ? Beams{} : Beams{rings, -24.8, 2.0, 0.2}; }

class DetectCloudSimulated : public testing::TestWithParam<Case> {};

TEST_P(DetectCloudSimulated, FindsThePlateWhereItIs) {
  const Case& c = GetParam();
  const double lift_m = c.rings == 16 ? 0.0 : std::max(-0.5, -0.15 * c.distance_m);
  const Panel plate = PlateAt(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * Vector3d(c.distance_m, 0, lift_m), kPlate_m,
                              c.yaw_deg * kDegree, c.pitch_deg * kDegree, c.roll_deg * kDegree);
  const AnnotatedCloud found = DetectPlate(Scan(Room(plate), BeamsOf(c.rings)), Board());
  ASSERT_TRUE(found.view.found) << found.view.why_not;
  EXPECT_LE(found.view.candidates.size(), kPatchesMax);
  EXPECT_TRUE(std::is_sorted(found.view.candidates.begin(), found.view.candidates.end(),
                             [](const PlanePatch& a, const PlanePatch& b) { return a.score > b.score; }));
  const PlanePatch* patch = Match(found.view, plate, 0.2);
  ASSERT_NE(patch, nullptr);
  EXPECT_EQ(patch, &found.view.candidates.front());
  EXPECT_LT(patch->normal.dot(patch->centre_m), 0);
  EXPECT_NEAR(patch->normal.norm(), 1, 1e-9);
  EXPECT_LT(Angle_deg(*patch, plate), 2);
  EXPECT_LT(std::abs(patch->normal.dot(plate.centre_m - patch->centre_m)), 0.01);
  EXPECT_LT(Beyond_m(*patch, plate), 0.0);
  EXPECT_LT(patch->rms_m, 0.025);
}

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const int rings : {16, 64})
    for (const double distance_m : {2.0, 3.5, 5.0, 8.0})
      for (const double roll_deg : {0.0, 45.0}) {
        cases.push_back({rings, distance_m, 10, 5, roll_deg});
        cases.push_back({rings, distance_m, 35, -30, roll_deg});
        cases.push_back({rings, distance_m, -50, 0, roll_deg});
      }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Poses, DetectCloudSimulated, testing::ValuesIn(Cases()));

TEST(DetectCloud, SeesAPlateBeforeAWall) {
  const Panel plate = PlateAt({4, 0, 0}, kPlate_m, 0.2, 0, 0.3);
  std::vector<Panel> panels = Room(plate);
  panels.push_back({{4.5, 0, 0}, Vector3d::UnitY(), Vector3d::UnitZ(), {3, 3}});
  const AnnotatedCloud found = DetectPlate(Scan(panels, {}), Board());
  ASSERT_NE(Match(found.view, plate, 0.15), nullptr) << found.view.why_not;
  EXPECT_EQ(Match(found.view, plate, 0.15), &found.view.candidates.front());
}

TEST(DetectCloud, OffersEveryBoardInView) {
  const Panel one = PlateAt({4, -1, 0}, kPlate_m, 0.2, 0, 0), two = PlateAt({3, 2, 0}, kPlate_m, -0.4, 0.2, 0.8);
  std::vector<Panel> panels = Room(one);
  panels.push_back(two);
  const AnnotatedCloud found = DetectPlate(Scan(panels, {}), Board());
  ASSERT_GE(found.view.candidates.size(), 2u);
  for (const Panel& plate : {one, two}) {
    const PlanePatch* patch = Match(found.view, plate, 0.15);
    ASSERT_NE(patch, nullptr);
    EXPECT_LT(patch - found.view.candidates.data(), 2);
  }
}

TEST(DetectCloud, LeavesOutWhatLiesInTheSamePlaneBeyondThePlate) {
  const Panel plate = PlateAt({3, 0, 0}, kPlate_m, 0, 0, 0);
  Panel arm = plate;
  arm.centre_m += plate.u * 0.6;
  arm.half_m = {0.2, 0.06};
  std::vector<Panel> panels = Room(plate);
  panels.push_back(arm);
  const AnnotatedCloud found = DetectPlate(Scan(panels, {}), Board());
  const PlanePatch* patch = Match(found.view, plate, 0.1);
  ASSERT_NE(patch, nullptr) << found.view.why_not;
  EXPECT_LT(Beyond_m(*patch, plate), 0.0);
}

TEST(DetectCloud, TakesNeitherWallNorFloorNorAPieceOfThem) {
  std::vector<Panel> panels = Room(PlateAt({3, 0, 0}, kPlate_m, 0, 0, 0));
  panels.pop_back();
  for (const int rings : {16, 64}) {
    const AnnotatedCloud found = DetectPlate(Scan(panels, BeamsOf(rings)), Board());
    for (const PlanePatch& patch : found.view.candidates) EXPECT_LT(patch.score, 0.4) << rings << " rings";
  }
}

TEST(DetectCloud, FindsAPlateOfASolidStateLidarThatLooksAlongZ) {
  const Panel plate = PlateAt({4, 0.3, 0.2}, kPlate_m, 0.3, 0.1, 0.5);
  const Beams beams{100, -20, 20, 0.3, -35, 35, 0.01};
  Cloud cloud = Scan(Room(plate), beams);
  for (Eigen::Vector3f& p : cloud.points_m) p = {-p.y(), -p.z(), p.x()};
  const AnnotatedCloud found = DetectPlate(cloud, Board());
  ASSERT_TRUE(found.view.found) << found.view.why_not;
  const Vector3d centre(-plate.centre_m.y(), -plate.centre_m.z(), plate.centre_m.x());
  EXPECT_LT((found.view.candidates.front().centre_m - centre).norm(), 0.03);
}

TEST(DetectCloud, AssumesAPlateAboutThePatternWhereNoneWasMeasured) {
  Target board{TargetId("board"), 7, 5, 0.095, 0.0, ""};
  const Panel plate = PlateAt({3, 1, 0}, kPlate_m, 0.3, 0, 0.5);
  const AnnotatedCloud found = DetectPlate(Scan(Room(plate), {}), board);
  const PlanePatch* patch = Match(found.view, plate, 0.1);
  ASSERT_NE(patch, nullptr) << found.view.why_not;
  EXPECT_LT(Angle_deg(*patch, plate), 2);
  EXPECT_LT(Beyond_m(*patch, plate), 0.0);
}

TEST(DetectCloud, GivesTheSameAnswerEachTime) {
  const Cloud cloud = Scan(Room(PlateAt({3, 1, 0}, kPlate_m, 0.3, 0, 0.5)), {});
  const AnnotatedCloud a = DetectPlate(cloud, Board()), b = DetectPlate(cloud, Board());
  EXPECT_EQ(a.picture, b.picture);
  ASSERT_EQ(a.view.candidates.size(), b.view.candidates.size());
  for (std::size_t i = 0; i < a.view.candidates.size(); ++i) {
    EXPECT_EQ(a.view.candidates[i].normal, b.view.candidates[i].normal);
    EXPECT_EQ(a.view.candidates[i].points_m, b.view.candidates[i].points_m);
  }
}

}  // namespace
}  // namespace rigcal::detect
