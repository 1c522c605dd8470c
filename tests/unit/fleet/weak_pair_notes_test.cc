// What is said of weak pairs that take no part.
#include <gtest/gtest.h>

#include "server/fleet/weak_edges.h"

namespace rigcal::fleet {
namespace {

Edge WeakPair(const char* id, double off_m) {
  Edge edge;
  edge.id = EdgeId(std::string(63, '0') + id);
  edge.frame_a = SensorId("left"), edge.frame_b = SensorId("right");
  edge.method = "lidar_lidar", edge.session = SessionId("visit");
  edge.state = EdgeState::kGood;
  edge.T_a_b.p_m = {1.0 + off_m, 0, 0};
  edge.uncertainty = FromInformation(1e6 * Matrix6d::Identity(), UncertaintySource::kModel, 12);
  edge.figures["overlap_ratio"] = 0.31;
  return edge;
}

GraphSolution SolutionOf(bool known) {
  GraphSolution solution;
  for (const char* sensor : {"left", "right"}) {
    SensorPose pose;
    pose.sensor = SensorId(sensor);
    pose.known = known;
    if (pose.sensor == SensorId("right")) pose.T_ref_sensor.p_m = {1, 0, 0};
    solution.poses.push_back(pose);
  }
  return solution;
}

TEST(WeakEdgeNotes, TellOfAPairOnceWhyAndHowFarItIsOff) {
  const std::vector<Edge> edges = {WeakPair("1", 0.03), WeakPair("2", 0.25), WeakPair("3", 0.01)};
  const std::set<EdgeId> weak = {edges[0].id, edges[1].id};
  const auto notes = NotesOnWeakEdges(edges, weak, SolutionOf(true));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].what,
            "left - right takes no part: 31 % of one cloud lie where the other has points, and better pairs hold both; "
            "it is 250 mm and 0 deg off from where these have them");
  EXPECT_TRUE(NotesOnWeakEdges(edges, {}, SolutionOf(true)).empty());
  EXPECT_TRUE(NotesOnWeakEdges(edges, weak, SolutionOf(false)).empty());
}

// Of directions that the pair does not see nothing is said.
TEST(WeakEdgeNotes, LeaveOutWhatThePairDoesNotSee) {
  Edge edge = WeakPair("1", 0.25);
  Matrix6d Omega = 1e6 * Matrix6d::Identity();
  Omega(0, 0) = 0;
  edge.uncertainty = FromInformation(Omega, UncertaintySource::kModel, 12);
  const auto notes = NotesOnWeakEdges({edge}, {edge.id}, SolutionOf(true));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].what.find("it sees 5 of 6 directions"), std::string::npos) << notes[0].what;
  EXPECT_NE(notes[0].what.find("it is 0 mm and 0 deg off"), std::string::npos) << notes[0].what;
}

}  // namespace
}  // namespace rigcal::fleet
