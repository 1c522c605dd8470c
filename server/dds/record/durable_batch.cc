#include "server/dds/record/durable_batch.h"

#include "server/base/files/durable_file.h"
#include "server/base/process/parallel_for.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"

namespace rigcal::dds {
namespace {

Status SyncAll(const std::vector<storage::FinishedFile>& files) {
  std::vector<Status> synced(files.size());
  ParallelFor(files.size(), [&](std::size_t i) { synced[i] = SyncFile(files[i].path); });
  for (const Status& one : synced) RIGCAL_TRY(one);
  return {};
}

Status Close(storage::Store& store, const SessionId& session, Stamp now) {
  RIGCAL_ASSIGN(const auto manifest, storage::LoadManifest(store, session));
  if (!manifest)
    return Fail(ErrorCode::kStorage, "session " + session.str() + " has no manifest", "Run `rigcal doctor`");
  RIGCAL_ASSIGN(const auto before, storage::LoadSession(store, session));
  RIGCAL_TRY(storage::CloseSession(store, session, PairsToCalibrate(manifest->header), now));
  if (!before || !before->closed) return {};
  // What the disk had lost was sent again, and the session with it.
  const Word word{now, "robot " + before->robot.str(), ""};
  if (const auto current = storage::MakeCurrent(store, session, storage::MadeCurrent::kPushedAgain, word); !current)
    return Fail(current.error());
  return {};
}

Status Record(storage::Store& store, const DurableBatch& batch, Stamp now) {
  for (const auto& [session, idx] : batch.held)
    RIGCAL_TRY(storage::AppendHeld(store, session, {idx.begin(), idx.end()}, now));
  for (const SessionId& session : batch.closing) RIGCAL_TRY(Close(store, session, now));
  return {};
}

}  // namespace

Status Persist(storage::Store& store, const DurableBatch& batch, CachedFiles& cached, Stamp now) {
  RIGCAL_TRY(SyncAll(batch.files));
  RIGCAL_TRY(storage::AdoptBlobs(store.BlobFolder(), batch.files));
  RIGCAL_TRY(store.Write([&] { return Record(store, batch, now); }));
  for (const storage::FinishedFile& file : batch.files) cached.Add(storage::BlobPath(store.BlobFolder(), file.digest));
  return {};
}

}  // namespace rigcal::dds
