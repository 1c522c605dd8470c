#include "server/own_place.h"

#include "server/base/digests/sha256.h"
#include "server/base/files/private_files.h"
#include "server/base/log.h"
#include "server/bucket_watch.h"
#include "server/http/public_address.h"
#include "server/standby.h"
#include "storage/database/log_damage.h"
#include "storage/files/folder_lock.h"
#include "storage/files/room.h"

namespace rigcal {
namespace {

Result<storage::Store> OpenFirst(const Config& config) {
  if (IsOpenToOthers(config.data)) LogWarn(OpenFolderText(config.data));
  storage::KeepReserve(config.data);
  const auto doubt = storage::LogInDoubt(config.data);
  RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(config.place));
  for (const auto& lost : {doubt, storage::LogThatWent(config.data)})
    if (lost) LogWarn(lost->what + ". " + lost->cure);
  RIGCAL_TRY(BeginWithBucket(store));
  return store;
}

Status OpenAlone(const Config& config, OwnPlace& own) {
  RIGCAL_TRY(storage::LockFolder(config.data));
  RIGCAL_ASSIGN(own.store, OpenFirst(config));
  return {};
}

Status OpenShared(const Config& config, OwnPlace& own) {
  RIGCAL_ASSIGN(own.intake, storage::ShareFolder(config.data, http::MachineName()));
  own.self.owner = own.intake + ":" + config.data.string();
  own.self.receivers = config.webhooks;
  RIGCAL_ASSIGN(own.store, OpenFirst(config));
  return storage::AppendServer(*own.store, own.self);
}

// Told to everybody on the network: not the id itself, by which a folder is known.
Result<std::string> ToldStoreId(storage::Store& store) {
  constexpr std::size_t kDigits = 16;
  RIGCAL_ASSIGN(const std::string id, storage::LoadStoreId(store));
  return Sha256Of(id).str().substr(0, kDigits);
}

}  // namespace

Result<OwnPlace> ClaimOwnPlace(const Config& config, const http::Options& options, const sigset_t& signals,
                               const std::function<void()>& hang_up) {
  OwnPlace own;
  std::string store_id;
  if (!config.place.server.empty()) {
    RIGCAL_TRY(OpenShared(config, own));
    RIGCAL_ASSIGN(store_id, ToldStoreId(*own.store));
  }
  RIGCAL_ASSIGN(own.only, ClaimPlace(config, options, signals, hang_up, store_id));
  if (own.only && !own.store) RIGCAL_TRY(OpenAlone(config, own));
  return own;
}

Result<std::optional<wire::ServerName>> WhoElseSpeaks(const Config& config, dds::OnlyServer& only) {
  if (!config.standby) return SettleBeside(only);
  if (config.place.server.empty()) return std::nullopt;  // it waited for its place, and has it
  return only.Before();
}

}  // namespace rigcal
