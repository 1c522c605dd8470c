// Merged edges come back bit for bit, and say which edges are in none.
#include "storage/revisions/merged_edges.h"

#include <algorithm>
#include <filesystem>

#include "storage/sessions/retired.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

MergedEdge MakeMerged(double seed) {
  MergedEdge merged;
  merged.frame_a = SensorId("left"), merged.frame_b = SensorId("right");
  merged.method = "given";
  merged.count = 3;
  merged.newest = {77};
  Vector6d xi;
  xi << 0.1, 0.2, 0.3, 0.4, 0.5, seed;
  merged.T_a_b = Se3::Exp(xi);
  merged.Omega = Vector6d::LinSpaced(1, 6).asDiagonal();
  merged.Omega(0, 1) = merged.Omega(1, 0) = seed / 3;
  merged.scatter = 2 * merged.Omega, merged.given = seed * merged.Omega;
  merged.source = UncertaintySource::kJackknife;
  merged.dof = 45;
  merged.by_blocks = true;
  merged.constants = {{"board", {xi, 2 * xi}}, {"lens", {-xi}}};
  return merged;
}

class MergedEdgesTest : public StoreTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
    for (int i = 0; i < 5; ++i) Append(MakeEdge(i));
  }
  void Append(const Edge& edge) {
    ASSERT_TRUE(AppendEdge(store_, edge, {1}));
    ids_.push_back(edge.id);
  }
  void Merge(const MergedEdge& merged, const std::vector<EdgeId>& taken, const std::vector<EdgeId>& kept) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
      return AppendMergedEdges(store_, {kRobot, number}, {{merged}, taken, kept}, *LoadWhatCounts(store_, kRobot));
    }));
  }
  std::vector<EdgeId> Unmerged() {
    std::vector<EdgeId> ids;
    const auto edges = LoadUnmergedEdges(store_, kRobot, EdgeParts::kAll);
    for (const Edge& edge : *edges) ids.push_back(edge.id);
    return ids;
  }
  static std::vector<EdgeId> Sorted(std::vector<EdgeId> ids) {
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  std::vector<EdgeId> ids_;
};

// By it the graph of the moment leaves out the edges that a revision leaves out.
TEST_F(MergedEdgesTest, RowsOfEdgesTellHowFarCloudsOverlap) {
  Edge edge = MakeEdge(7);
  edge.figures = {{"overlap_ratio", 0.31}, {"voxel_m", 1.0}};
  Append(edge);
  const auto rows = LoadUnmergedEdges(store_, kRobot, EdgeParts::kRow);
  ASSERT_TRUE(rows) << WordsOf(rows);
  const auto found = std::find_if(rows->begin(), rows->end(), [&](const Edge& one) { return one.id == edge.id; });
  ASSERT_NE(found, rows->end());
  EXPECT_EQ(found->figures, (std::map<std::string, double>{{"overlap_ratio", 0.31}}));
}

TEST_F(MergedEdgesTest, OfWeakEdgesComeBackAsSuch) {
  for (const bool weak : {true, false}) {
    MergedEdge merged = MakeMerged(0.1);
    merged.of_sessions = true, merged.weak = weak;
    Merge(merged, {}, {});
    const auto loaded = LoadMergedEdges(store_, kRobot);
    ASSERT_TRUE(loaded) << WordsOf(loaded);
    ASSERT_EQ(loaded->size(), 1u);
    EXPECT_EQ(loaded->front().weak, weak);
  }
}

TEST_F(MergedEdgesTest, ComeBackBitForBitOfTheNewestRevision) {
  Merge(MakeMerged(0.1), {ids_[0]}, {});
  Merge(MakeMerged(0.7), {ids_[1]}, {});
  const auto loaded = LoadMergedEdges(store_, kRobot);
  ASSERT_TRUE(loaded) << WordsOf(loaded);
  ASSERT_EQ(loaded->size(), 1u);
  const MergedEdge &stored = loaded->front(), made = MakeMerged(0.7);
  EXPECT_EQ(stored.frame_a, made.frame_a);
  EXPECT_EQ(stored.frame_b, made.frame_b);
  EXPECT_EQ(stored.method, made.method);
  EXPECT_EQ(stored.count, made.count);
  EXPECT_EQ(stored.newest.ns, made.newest.ns);
  EXPECT_EQ(stored.T_a_b.p_m, made.T_a_b.p_m);
  EXPECT_EQ(stored.T_a_b.q.coeffs(), made.T_a_b.q.coeffs());
  EXPECT_EQ(stored.Omega, made.Omega);
  EXPECT_EQ(stored.scatter, made.scatter);
  EXPECT_EQ(stored.given, made.given);
  EXPECT_EQ(stored.source, made.source);
  EXPECT_EQ(stored.dof, made.dof);
  EXPECT_EQ(stored.by_blocks, made.by_blocks);
  EXPECT_EQ(stored.constants, made.constants);
}

TEST_F(MergedEdgesTest, EveryEdgeThatCountsIsInNoneUntilItIsTaken) {
  EXPECT_EQ(Unmerged(), Sorted(ids_));
  Merge(MakeMerged(0.1), {ids_[0], ids_[3]}, {});
  EXPECT_EQ(Unmerged(), Sorted({ids_[1], ids_[2], ids_[4]}));
  Append(MakeEdge(9));
  EXPECT_EQ(Unmerged(), Sorted({ids_[1], ids_[2], ids_[4], ids_[5]}));
  EXPECT_EQ(LoadEdges(store_, kRobot, false)->size(), 6u);  // nothing is lost
}

TEST_F(MergedEdgesTest, AreOutdatedByARetiredOneUntilTheyAreMadeAnew) {
  Merge(MakeMerged(0.1), {ids_[0], ids_[3]}, {});
  ASSERT_TRUE(RetireEdge(store_, ids_[1], {{4}, "Ada", "typed wrong"}));
  EXPECT_FALSE(*IsMergeOutdated(store_, kRobot, *LoadWhatCounts(store_, kRobot)));
  ASSERT_TRUE(RetireEdge(store_, ids_[3], {{5}, "Ada", "typed wrong"}));
  EXPECT_TRUE(*IsMergeOutdated(store_, kRobot, *LoadWhatCounts(store_, kRobot)));
  Merge(MakeMerged(0.2), {ids_[0]}, {ids_[1], ids_[2], ids_[3], ids_[4]});
  EXPECT_FALSE(*IsMergeOutdated(store_, kRobot, *LoadWhatCounts(store_, kRobot)));
  EXPECT_EQ(Unmerged(), Sorted({ids_[1], ids_[2], ids_[3], ids_[4]}));
}

TEST_F(MergedEdgesTest, AreMadeAnewWhereMoreVisitsAreToStayAsTheyAre) {
  const auto merge = [&](std::int64_t visits_in_full) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
      MergeStep step{{MakeMerged(0.1)}, {}, {}};
      step.visits_in_full = visits_in_full;
      return AppendMergedEdges(store_, {kRobot, number}, step, {});
    }));
  };
  EXPECT_FALSE(*IsToMergeAnew(store_, kRobot, 8));
  EXPECT_TRUE(*IsToMergeAnew(store_, kRobot, 9));
  merge(12);
  EXPECT_FALSE(*IsToMergeAnew(store_, kRobot, 12));
  EXPECT_TRUE(*IsToMergeAnew(store_, kRobot, 13));
  merge(5);
  EXPECT_TRUE(*IsToMergeAnew(store_, kRobot, 6));
}

TEST_F(MergedEdgesTest, AreFoundWithTheEdgesThatTheyStandFor) {
  const EdgeId id(DigestOf("merged").str());
  MergedEdge merged = MakeMerged(0.1);
  const auto edge = LoadEdge(store_, ids_[0]).value().value();
  merged.frame_a = edge.frame_a, merged.frame_b = edge.frame_b, merged.method = edge.method;
  merged.of_sessions = !edge.session.empty();
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
    return AppendMergedEdges(store_, {kRobot, number}, {{merged}, {ids_[0]}, {}, {id}}, {});
  }));
  EXPECT_EQ(*FindMergedEdges(store_, id.str().substr(0, 8), RobotId()), std::vector<EdgeId>{id});
  EXPECT_TRUE(FindMergedEdges(store_, id.str().substr(0, 8), RobotId("other"))->empty());
  EXPECT_EQ(*LoadIdsWithin(store_, kRobot, merged), std::vector<EdgeId>{ids_[0]});
  merged.of_sessions = !merged.of_sessions;
  EXPECT_TRUE(LoadIdsWithin(store_, kRobot, merged)->empty());
}

TEST_F(MergedEdgesTest, OfAnEarlierRevisionComeBackToo) {
  Merge(MakeMerged(0.1), {ids_[0]}, {});
  Merge(MakeMerged(0.7), {ids_[1]}, {});
  EXPECT_EQ(LoadMergedEdges(store_, kRobot, 1)->front().Omega, MakeMerged(0.1).Omega);
  EXPECT_EQ(LoadMergedEdges(store_, kRobot, 2)->front().Omega, MakeMerged(0.7).Omega);
}

TEST_F(MergedEdgesTest, OfSessionsComeBackWithTheirScoresOfTheNewestRevision) {
  MergedEdge of_sessions = MakeMerged(0.3);
  of_sessions.of_sessions = true;
  of_sessions.scores = Eigen::Matrix<double, 6, Eigen::Dynamic>::NullaryExpr(6, 7, [](Eigen::Index i, Eigen::Index j) {
    return 0.1 * static_cast<double>(i) - 1.0 / (3.0 + static_cast<double>(j));
  });
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
    return AppendMergedEdges(store_, {kRobot, number}, {{MakeMerged(0.1), of_sessions}, {}, {}}, {});
  }));
  const auto newest = LoadMergedEdges(store_, kRobot);
  ASSERT_TRUE(newest);
  ASSERT_EQ(newest->size(), 2u);  // of one pair and method
  EXPECT_FALSE((*newest)[0].of_sessions);
  EXPECT_EQ((*newest)[0].scores.cols(), 0);
  EXPECT_TRUE((*newest)[1].of_sessions);
  EXPECT_EQ((*newest)[1].scores, of_sessions.scores);
  EXPECT_EQ((*newest)[1].constants, of_sessions.constants);
  Merge(MakeMerged(0.7), {}, {});
  EXPECT_EQ((*LoadMergedEdges(store_, kRobot, 1))[1].scores.cols(), 0);
  EXPECT_EQ((*LoadMergedEdges(store_, kRobot, 1))[1].Omega, of_sessions.Omega);
}

TEST_F(MergedEdgesTest, OfAPairThatContradictEachOtherComeBackAsParts) {
  std::vector<MergedEdge> parts = {MakeMerged(0.1), MakeMerged(0.3), MakeMerged(0.7)};
  parts[1].part = 1, parts[2].part = 2;
  parts[1].constants = {{"lens", {Vector6d::Ones()}}};
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
    return AppendMergedEdges(store_, {kRobot, number}, {parts, {}, {}}, {});
  }));
  for (const int number : {0, 1}) {
    const auto loaded = LoadMergedEdges(store_, kRobot, number);
    ASSERT_TRUE(loaded && loaded->size() == 3) << WordsOf(loaded);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ((*loaded)[k].part, static_cast<int>(k));
      EXPECT_FALSE((*loaded)[k].of_sessions);
      EXPECT_EQ((*loaded)[k].Omega, parts[k].Omega);
      EXPECT_EQ((*loaded)[k].constants, parts[k].constants);
    }
  }
  Merge(MakeMerged(0.7), {}, {});
  EXPECT_EQ(LoadMergedEdges(store_, kRobot)->size(), 1u);
}

TEST_F(MergedEdgesTest, AreFoundByTheIdThatTheyHaveInTheNewestRevision) {
  const auto merge = [&](const std::vector<EdgeId>& ids) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
      return AppendMergedEdges(store_, {kRobot, number}, {{MakeMerged(0.1)}, {}, {}, ids},
                               *LoadWhatCounts(store_, kRobot));
    }));
  };
  const EdgeId first(DigestOf("first").str()), stays(DigestOf("stays").str()), last(DigestOf("last").str());
  merge({first, stays});
  EXPECT_EQ(FindRobotOfMerged(store_, first).value(), kRobot);
  merge({stays, last});
  EXPECT_EQ(FindRobotOfMerged(store_, first).value(), std::nullopt);
  EXPECT_EQ(FindRobotOfMerged(store_, stays).value(), kRobot);
  EXPECT_EQ(FindRobotOfMerged(store_, last).value(), kRobot);
  EXPECT_EQ(FindRobotOfMerged(store_, ids_[0]).value(), std::nullopt);
}

TEST_F(MergedEdgesTest, OneRobotHasNoneOfAnother) {
  ASSERT_TRUE(AppendRobot(store_, RobotId("other"), {1}));
  Merge(MakeMerged(0.1), {ids_[0]}, {});
  EXPECT_TRUE(LoadMergedEdges(store_, RobotId("other"), 0)->empty());
  EXPECT_TRUE(LoadUnmergedEdges(store_, RobotId("other"), EdgeParts::kAll)->empty());
}

// Version 14, which knew no sessions in merged edges and found repeats, remounts and listed sensors in the manifests.
std::string StoreOfVersion14() {
  std::string sql = EmptyStoreOfVersion(14);
  const std::string digest(64, 'd'), other(64, 'e'), matrix = "zeroblob(288)";
  sql +=
      "INSERT INTO robot VALUES ('r', 1);"
      "INSERT INTO revision VALUES ('r', 7, 1, 2, 'pass', '', '', '', '{}');"
      "INSERT INTO merged_edge VALUES ('r', 7, 'a', 'b', 'given', 5, 77, 1.5, 0, 0, 0, 0, 0, 1, 'given', 0, 1, " +
      matrix + ", " + matrix + ", " + matrix +
      ");"
      "INSERT INTO merged_edge_constant VALUES ('r', 7, 'a', 'b', 'given', 'board', zeroblob(48));";
  const std::string listed = "\"sensors\":[{\"id\":\"left\"},{\"id\":\"right\"}]";
  sql += "INSERT INTO session VALUES (1, 's1', 'r', 10, 1, '', 1, 5, '{" + listed +
         "}'),"
         "(2, 's2', 'r', 20, 2, '', 2, 5, '{\"remounted\":[\"left\"]," +
         listed +
         "}'), (3, 's3', 'r', 30, 3, '', 1, 5, '{\"sensors\":[{\"id\":\"never\"}]}');"
         "INSERT INTO payload VALUES (1, 0, 'x', '" +
         digest + "', 5), (2, 0, 'x', '" + digest + "', 5), (2, 1, 'y', '" + other + "', 5), (3, 0, 'z', '" + other +
         "', 5);"
         "INSERT INTO session_closed VALUES (1, 5), (2, 6);"
         "INSERT INTO standing (robot_id, at_ns, how, session_number, who, reason) VALUES ('r', 5, 'pushed', 1, 'r', "
         "''), ('r', 6, 'pushed', 2, 'r', '');";
  return sql;
}

TEST(MergedEdgesMigration, KeepsWhatVersion14Knew) {
  const TempFolder folder;
  MakeDatabase(folder.path(), StoreOfVersion14());
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const RobotId robot("r");
  const auto merged = LoadMergedEdges(*store, robot);
  ASSERT_TRUE(merged && merged->size() == 1);
  EXPECT_FALSE(merged->front().of_sessions);
  EXPECT_EQ(merged->front().count, 5);
  EXPECT_EQ(merged->front().T_a_b.p_m.x(), 1.5);
  EXPECT_EQ(merged->front().constants.at("board").size(), 1u);
  const auto counts = LoadWhatCounts(*store, robot);
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->superseded.at(SessionId("s1")).by, SessionId("s2"));
  EXPECT_FALSE(counts->superseded.contains(SessionId("s2")));  // by one that did not come whole
  ASSERT_EQ(counts->epochs.size(), 1u);
  EXPECT_EQ(counts->epochs[0].session, SessionId("s2"));
  EXPECT_EQ(*LoadListedSensors(*store, robot), (std::vector<SensorId>{SensorId("left"), SensorId("right")}));
  EXPECT_FALSE(*IsMergeOutdated(*store, robot, *counts));
}

}  // namespace
}  // namespace rigcal::storage
