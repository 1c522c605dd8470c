#include "server/pipeline/revisions/revision_cache.h"

#include <algorithm>

#include "server/pipeline/robots/robot_rows.h"

namespace rigcal::pipeline {
namespace {
constexpr std::size_t kEntriesMax = 16;
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
