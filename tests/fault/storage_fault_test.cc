// The n-th operation on the disk fails, for every n: a transaction is there whole or not at all, what was acknowledged
// is there, and the store works again.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "storage/audit.h"
#include "storage/migrate.h"
#include "tests/fault/fault_disk.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using fault::Fault;
using fault::FaultDisk;
namespace fs = std::filesystem;

constexpr int kOperationsMax = 2000;  // no act here needs so many: one that never succeeds is a failure
constexpr int kPayloads = 40;
constexpr int kEdges = 12;
const SensorPair kPair{SensorId("left"), SensorId("right")};

enum class Extent { kNone, kWhole, kHalf };

struct Act {
  const char* name;
  Status (*run)(Store&);     // may be repeated
  Extent (*extent)(Store&);  // how much of it is stored
};

Extent ExtentOf(bool any, bool all) { return all ? Extent::kWhole : any ? Extent::kHalf : Extent::kNone; }

Status PushSession(Store& store) {
  const Manifest manifest = MakeManifest(kPayloads);
  std::vector<std::uint32_t> all(kPayloads);
  for (std::uint32_t i = 0; i < kPayloads; ++i) all[i] = i;
  return store.Write([&]() -> Status {
    RIGCAL_TRY(
        AppendSession(store, IdOf(manifest), R"({"filled": ")" + std::string(20'000, 'm') + "\"}", manifest, {1}));
    RIGCAL_TRY(AppendHeld(store, IdOf(manifest), all, {2}));
    return CloseSession(store, IdOf(manifest), {kPair}, {3});
  });
}

Extent SessionExtent(Store& store) {
  const SessionId id = IdOf(MakeManifest(kPayloads));
  const std::optional<SessionRow> row = LoadSession(store, id).value();
  const bool held = row && LoadHeld(store, id).value() == std::vector<bool>(kPayloads, true);
  return ExtentOf(row.has_value(), held && row->closed && CountJobs(store, id).value().waiting == 1);
}

Status PushItems(Store& store, int first, int end) {
  const BatchId batch(DigestOf("batch").str());
  return store.Write([&]() -> Status {
    RIGCAL_TRY(AppendBatch(store, kRobot, batch, kEdges, {1}));
    for (int i = first; i < end; ++i) RIGCAL_TRY(AppendBatchItems(store, batch, {{i, MakeEdge(i)}}, {1}));
    return {};
  });
}

Status PushEdges(Store& store) { return PushItems(store, 0, kEdges); }

// The first item alone, as a client asks what the server holds, then the rest in two transactions.
Status PushEdgesInParts(Store& store) {
  RIGCAL_TRY(PushItems(store, 0, 1));
  RIGCAL_TRY(PushItems(store, 1, kEdges / 2));
  return PushItems(store, kEdges / 2, kEdges);
}

Extent EdgesExtent(Store& store) {
  const std::vector<Edge> edges = LoadEdges(store, kRobot, true).value();
  const auto held = LoadBatchHeld(store, BatchId(DigestOf("batch").str())).value();
  bool whole = edges.size() == kEdges && held == std::vector<bool>(kEdges, true);
  for (const Edge& edge : edges) whole = whole && edge.uncertainty.blocks.size() == 3 && edge.evidence.size() == 1;
  whole = whole && LoadOpenBatches(store, kRobot).value().empty();
  return ExtentOf(!edges.empty() || held.has_value(), whole);
}

// Parts may be stored, but none of them counts before all do.
Extent CountedEdgesExtent(Store& store) {
  const auto unsolved = LoadUnsolvedRobots(store).value();
  const bool asks = std::find(unsolved.begin(), unsolved.end(), kRobot) != unsolved.end();
  const bool any = !LoadEdges(store, kRobot, true).value().empty() || LoadEdgeWatermark(store, kRobot).value() > 0;
  if (any != asks) return Extent::kHalf;
  return any ? EdgesExtent(store) : Extent::kNone;
}

// Still 100 kB when it is compressed.
const std::string& LargeDocument() {
  static const std::string text = [] {
    std::string digests;
    for (int i = 0; i < 3200; ++i) digests += DigestOf(std::to_string(i)).str();
    return digests;
  }();
  return text;
}

// With the checkpoint that moves it from the log to the database file.
Status CommitRevision(Store& store) {
  Revision revision = MakeRevision(5);
  revision.document = LargeDocument();
  if (LoadRevision(store, kRobot, 1).value_or(std::nullopt)) return {};
  RIGCAL_TRY(AppendRevision(store, revision));
  store.database().tryExec("PRAGMA wal_checkpoint(TRUNCATE)");
  return {};
}

Extent RevisionExtent(Store& store) {
  const std::optional<Revision> revision = LoadRevision(store, kRobot, 1).value();
  const bool whole = revision && revision->document == LargeDocument();
  return ExtentOf(revision || !LoadUnpublished(store).value().empty(), whole && LoadUnpublished(store)->size() == 1);
}

class DiskFault : public testing::TestWithParam<std::tuple<Fault, Act>> {
 protected:
  // What was acknowledged before the fault.
  static void AppendEarlier(Store& store) {
    ASSERT_TRUE(AppendEdge(store, MakeEdge(1, RobotId("earlier")), {1}));
    ASSERT_TRUE(AppendAudit(store, {1}, "Ada", "before"));
  }
  static void CheckEarlier(Store& store) {
    const std::vector<Edge> edges = LoadEdges(store, RobotId("earlier"), true).value();
    ASSERT_EQ(edges.size(), 1u);
    EXPECT_EQ(edges[0].uncertainty.blocks.size(), 3u);
    EXPECT_EQ(store.database().execAndGet("PRAGMA integrity_check").getString(), "ok");
  }
};

// False once the act needs fewer operations than `at`.
bool FailsAt(FaultDisk& disk, Fault fault, const Act& act, int at, void (*before)(Store&), void (*after)(Store&)) {
  const TempFolder folder;
  bool acknowledged = false;
  {
    Store store = std::move(*Store::Open(folder.path()));
    before(store);
    disk.Arm(fault, at);
    acknowledged = act.run(store).has_value();
    const bool recovered = fault != Fault::kOnce || act.run(store).has_value();
    EXPECT_TRUE(recovered) << "the connection works no more";
  }
  const bool failed = disk.failed();
  disk.Repair();
  Result<Store> store = Store::Open(folder.path());
  EXPECT_TRUE(store) << WordsOf(store);
  if (!store) return false;
  after(*store);
  const Extent extent = act.extent(*store);
  EXPECT_NE(extent, Extent::kHalf);
  const bool lost = (acknowledged || fault == Fault::kOnce) && extent != Extent::kWhole;
  EXPECT_FALSE(lost);
  EXPECT_TRUE(act.run(*store));
  EXPECT_EQ(act.extent(*store), Extent::kWhole);
  return failed;
}

TEST_P(DiskFault, LeavesAllOrNothing) {
  const auto& [fault, act] = GetParam();
  FaultDisk disk;
  int at = 1;
  while (at < kOperationsMax && !HasFailure()) {
    SCOPED_TRACE("operation " + std::to_string(at));
    if (!FailsAt(disk, fault, act, at, AppendEarlier, CheckEarlier)) break;
    ++at;
  }
  EXPECT_GT(at, 5) << "too few operations: the disk was not reached";
  EXPECT_LT(at, kOperationsMax);
  RecordProperty("operations", at - 1);
}

constexpr Fault kFaults[] = {Fault::kOnce, Fault::kFromThere, Fault::kPowerLoss};
constexpr Act kActs[] = {{"Session", PushSession, SessionExtent},
                         {"Edges", PushEdges, EdgesExtent},
                         {"EdgesInParts", PushEdgesInParts, CountedEdgesExtent},
                         {"Revision", CommitRevision, RevisionExtent}};

std::string NameOfCase(const testing::TestParamInfo<std::tuple<Fault, Act>>& info) {
  constexpr const char* kNames[] = {"Once", "FromThere", "PowerLoss"};
  return std::string(kNames[static_cast<int>(std::get<0>(info.param))]) + std::get<1>(info.param).name;
}

INSTANTIATE_TEST_SUITE_P(EveryOperation, DiskFault,
                         testing::Combine(testing::ValuesIn(kFaults), testing::ValuesIn(kActs)), NameOfCase);

// A store that is being made when the disk fails.
class MakingFault : public testing::TestWithParam<Fault> {};

TEST_P(MakingFault, LeavesAStoreThatOpens) {
  FaultDisk disk;
  bool failed = true;
  int at = 1;
  for (; failed && at < kOperationsMax && !HasFailure(); ++at) {
    SCOPED_TRACE("operation " + std::to_string(at));
    const TempFolder folder;
    disk.Arm(GetParam(), at);
    const bool opened = Store::Open(folder.path()).has_value();
    failed = disk.failed();
    EXPECT_TRUE(opened || failed);
    disk.Repair();
    Result<Store> store = Store::Open(folder.path());
    ASSERT_TRUE(store) << WordsOf(store);
    EXPECT_EQ(store->SchemaVersion(), NewestSchemaVersion());
    EXPECT_TRUE(PushEdges(*store));
    EXPECT_EQ(EdgesExtent(*store), Extent::kWhole);
  }
  EXPECT_GT(at, 10);
  EXPECT_LT(at, kOperationsMax);
}

INSTANTIATE_TEST_SUITE_P(EveryOperation, MakingFault, testing::ValuesIn(kFaults));

TEST(FullDisk, IsOneClearSentence) {
  FaultDisk disk;
  const TempFolder folder;
  Store store = std::move(*Store::Open(folder.path()));
  disk.Arm(Fault::kFromThere, 1);
  const Status done = PushEdges(store);
  disk.Repair();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kStorage);
  EXPECT_EQ(Sentence(done.error()),
            "the store at " + folder.path().string() + ": database or disk is full. Free some space on the disk.");
}

}  // namespace
}  // namespace rigcal::storage
