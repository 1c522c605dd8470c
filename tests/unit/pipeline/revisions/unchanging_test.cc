// What a numbered revision says stays what it said, whatever came after it.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/revisions/revise.h"
#include "storage/revisions/merged_edges.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class UnchangingTest : public PipelineTest {
 protected:
  // A session whose two pairs share their captures: `left` to `right`, and to `top`, whose height nobody measured.
  void Week(int week) {
    clock_.now.ns += 7 * kDay_ns;
    const std::string bytes = "week " + std::to_string(week);
    const SessionId session = StoreSession("r", {{"left/1.jpg", bytes + " left"}, {"right/1.jpg", bytes + " right"}});
    std::vector<Edge> edges = {GivenEdge("r", "left", "right", 1.0 + 1e-6 * week),
                               GivenEdge("r", "left", "top", 2.0 + 1e-6 * week)};
    Matrix6d Omega = edges[1].uncertainty.Omega;
    Omega(tangent::kZ, tangent::kZ) = 0.0;
    edges[1].uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    for (Edge& edge : edges) {
      edge.method = "stereo";
      edge.session = session;
      edge.id = EstimatedEdgeId(edge.robot, session, edge.method, edge.frame_a, edge.frame_b);
      TakeBlocks(week, edge.uncertainty);
    }
    StoreEdges(edges);
    for (auto job = storage::LoadNextJob(*store_, {}); job && *job; job = storage::LoadNextJob(*store_, {}))
      ASSERT_TRUE(store_->Write([&] { return storage::FinishJob(*store_, (*job)->number, clock_.now); }));
    const auto revised = Revise(*store_, kRig, clock_);
    ASSERT_TRUE(revised) << Sentence(revised.error());
  }
  // The same captures err in the same way in both pairs.
  static void TakeBlocks(int week, Uncertainty& uncertainty) {
    const bool is_level = uncertainty.rank < 6;
    uncertainty.source = UncertaintySource::kJackknife;
    uncertainty.dof = 11;
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {1.0, -1.0}) {
        const double size = is_level && axis == tangent::kZ ? 0.0 : sign * 1e-3 * std::sqrt(12.0 / 22.0);
        uncertainty.blocks.push_back({std::to_string(week) + "/" + std::to_string(axis) + (sign > 0.0 ? "+" : "-"),
                                      size * Vector6d::Unit(axis)});
      }
  }
  void Weeks(int from, int to) {
    for (int week = from; week < to; ++week) Week(week);
  }
  Result<std::string> Ask(const std::string& a, const std::string& b, int revision) {
    return Answer({*store_, clock_, cache_, clock_.now, ""}, "lookup",
                  json{{"robot", "r"}, {"a", a}, {"b", b}, {"revision", revision}}.dump());
  }
  // What is said of the pose itself.
  json Lookup(const std::string& a, const std::string& b, int revision) {
    const auto answer = Ask(a, b, revision);
    if (!answer) ADD_FAILURE() << Sentence(answer.error());
    const json whole = json::parse(answer.value_or("{}"));
    json said;
    for (const char* key :
         {"known", "T_a_b", "covariance", "sigma_m", "sigma_rad", "measured_part", "unobservable_basis", "verdict"})
      if (whole.contains(key)) said[key] = whole[key];
    return said;
  }
  // As a store has it that an older version made.
  void ForgetPlaces() {
    store_->database().exec("DROP TRIGGER revision_placed_no_delete; DELETE FROM revision_placed");
  }

  RevisionCache cache_;
};

TEST_F(UnchangingTest, APoseThatIsKnownInPartStaysAsItsRevisionToldIt) {
  Weeks(0, 12);
  ASSERT_FALSE(storage::LoadMergedEdges(*store_, kRig)->empty());
  const json first = Lookup("right", "top", 12), other = Lookup("top", "right", 12);
  EXPECT_EQ(first["known"], false);
  EXPECT_EQ(first["unobservable_basis"].size(), 1u);
  Weeks(12, 15);
  EXPECT_NE(Lookup("right", "top", 15), first);
  EXPECT_EQ(Lookup("right", "top", 12), first);
  EXPECT_EQ(Lookup("top", "right", 12), other);
}

TEST_F(UnchangingTest, WhatARevisionKeptIsWhatFollowsFromItsEdges) {
  Weeks(0, 12);
  const std::vector<std::pair<const char*, const char*>> pairs = {
      {"left", "top"}, {"top", "left"}, {"right", "top"}, {"top", "right"}, {"top", "top"}};
  std::vector<json> kept;
  for (const auto& [a, b] : pairs) kept.push_back(Lookup(a, b, 12));
  ForgetPlaces();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const json derived = Lookup(pairs[k].first, pairs[k].second, 12);
    EXPECT_EQ(derived["known"], kept[k]["known"]) << k;
    EXPECT_EQ(derived.value("unobservable_basis", json()), kept[k].value("unobservable_basis", json())) << k;
    if (kept[k]["known"] == true) continue;
    for (std::size_t axis = 0; axis < 6; ++axis)
      EXPECT_NEAR(derived["measured_part"]["covariance"][axis][axis].get<double>(),
                  kept[k]["measured_part"]["covariance"][axis][axis].get<double>(), 1e-15)
          << k << " " << axis;
  }
}

TEST_F(UnchangingTest, WhatARevisionOfBeforeDidNotKeepIsNotToldWithOtherNumbers) {
  Weeks(0, 12);
  ForgetPlaces();
  const json first = Lookup("right", "top", 5), newest = Lookup("right", "top", 12);
  Weeks(12, 15);
  const auto refused = Ask("right", "top", 12);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(refused.error().what,
            "how surely these two sensors are known to each other was not kept with revision 12 of robot r, and cannot "
            "be worked out since later revisions merged its older sessions");
  EXPECT_THAT(refused.error().cure, HasSubstr("`rigcal show r --revision 12`"));
  EXPECT_EQ(Lookup("right", "top", 5), first) << "nothing was merged then";
  EXPECT_EQ(Lookup("left", "right", 12)["known"], true) << "is kept with every revision";
}

}  // namespace
}  // namespace rigcal::pipeline
