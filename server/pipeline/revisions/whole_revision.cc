#include "server/pipeline/revisions/whole_revision.h"

#include <algorithm>
#include <unordered_map>

#include "server/graph/fusion/merged_edge.h"
#include "server/pipeline/robots/robot_rows.h"
#include "storage/edges/edges.h"
#include "storage/revisions/merged_edges.h"

namespace rigcal::pipeline {
namespace {

using EdgesById = std::unordered_map<EdgeId, Edge>;

Result<EdgesById> LoadStored(storage::Store& store, const std::vector<Edge>& edges, Blocks blocks) {
  std::vector<EdgeId> ids;
  for (const Edge& edge : edges) ids.push_back(edge.id);
  RIGCAL_ASSIGN(std::vector<Edge> stored, storage::LoadEdges(store, ids, blocks == Blocks::kLoaded));
  EdgesById by_id;
  for (Edge& edge : stored) {
    const EdgeId id = edge.id;
    by_id.emplace(id, std::move(edge));
  }
  return by_id;
}

Status AddMerged(storage::Store& store, const RobotId& robot, int number, EdgesById& by_id) {
  RIGCAL_ASSIGN(const auto all, storage::LoadMergedEdges(store, robot, number));
  for (const MergedEdge& merged : all) {
    Edge edge = graph::EdgeOf(merged, robot, false);
    const EdgeId id = edge.id;
    by_id.emplace(id, std::move(edge));
  }
  return {};
}

// A failed edge has no pose in a revision, whatever it had where it was measured.
void Complete(Edge details, Edge& edge) {
  details.state = edge.state;
  details.diagnoses = std::move(edge.diagnoses);
  if (details.state == EdgeState::kFailed) details.T_a_b = Se3(), details.uncertainty = Uncertainty();
  edge = std::move(details);
}

Error MissingEdge(const formats::RevisionInput& document, int number, const Edge& edge) {
  return {ErrorCode::kStorage,
          "revision " + std::to_string(number) + " of robot " + document.robot.str() + " refers to edge " +
              edge.id.str() + ", which is not in the store",
          "Restore the database from a backup."};
}

// A document of format 1.
void AddBlocks(EdgesById stored, std::vector<Edge>& edges) {
  for (Edge& edge : edges)
    if (const auto found = stored.find(edge.id); found != stored.end() && edge.state == EdgeState::kGood)
      edge.uncertainty.blocks = std::move(found->second.uncertainty.blocks);
}

constexpr std::size_t kEntriesMax = 16;
}  // namespace

Result<formats::RevisionInput> WithWholeEdges(storage::Store& store, int number, formats::RevisionInput document,
                                              Blocks blocks) {
  if (document.whole && blocks == Blocks::kLeftOut) return document;
  RIGCAL_ASSIGN(EdgesById stored, LoadStored(store, document.edges, blocks));
  if (document.whole) {
    AddBlocks(std::move(stored), document.edges);
    return document;
  }
  RIGCAL_TRY(AddMerged(store, document.robot, number, stored));
  for (Edge& edge : document.edges) {
    const auto found = stored.find(edge.id);
    if (found == stored.end()) return Fail(MissingEdge(document, number, edge));
    Complete(std::move(found->second), edge);
  }
  document.whole = true;
  return document;
}

Result<formats::RevisionInput> LoadWholeRevision(storage::Store& store, const Revision& revision, Blocks blocks) {
  RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(revision.document));
  return WithWholeEdges(store, revision.number, std::move(document), blocks);
}

std::shared_ptr<const formats::RevisionInput> RevisionCache::Find(const Digest& digest) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.digest == digest; });
  if (found == entries_.end()) return nullptr;
  std::rotate(entries_.begin(), found, found + 1);
  return entries_.front().document;
}

void RevisionCache::Keep(Entry entry) {
  const std::lock_guard lock(mutex_);
  entries_.push_front(std::move(entry));
  if (entries_.size() > kEntriesMax) entries_.pop_back();
}

Result<ParsedRevision> RevisionCache::Load(storage::Store& store, const RobotId& robot, std::int64_t number) {
  ParsedRevision parsed;
  RIGCAL_ASSIGN(parsed.summary, LoadRevisionSummaryOf(store, robot, number));
  parsed.document = Find(parsed.summary.digest);
  if (parsed.document) return parsed;
  RIGCAL_ASSIGN(const Revision whole, LoadRevisionOf(store, robot, parsed.summary.number));
  RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(whole.document));
  parsed.document = std::make_shared<const formats::RevisionInput>(std::move(document));
  Keep({parsed.summary.digest, parsed.document});
  return parsed;
}

}  // namespace rigcal::pipeline
