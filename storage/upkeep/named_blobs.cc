#include "storage/upkeep/named_blobs.h"

#include "storage/database/query.h"
#include "storage/files/blobs.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kShardCount = 256;

constexpr const char* kInputs =
    "SELECT DISTINCT p.digest, EXISTS (SELECT 1 FROM waiting_blob w WHERE w.digest = p.digest) FROM payload p "
    "JOIN payload_held h ON h.session_number = p.session_number AND h.idx = p.idx";
constexpr const char* kDerived =
    "SELECT digest FROM edge_evidence UNION "
    "SELECT picture_digest FROM detected_view WHERE picture_digest <> '' UNION "
    "SELECT picture_digest FROM detected_cloud WHERE picture_digest <> ''";
constexpr std::size_t kDigitsShown = 16;

}  // namespace

BlobFileKind KindOfBlobFile(const std::string& name) {
  if (CheckDigest("sha256", name)) return BlobFileKind::kBlob;
  if (name.find(".tmp-") != std::string::npos) return BlobFileKind::kHalf;
  return name.find(".damaged") != std::string::npos ? BlobFileKind::kSetAside : BlobFileKind::kForeign;
}

Status ForEachBlobFile(const fs::path& blob_folder,
                       const std::function<void(const fs::directory_entry&, BlobFileKind)>& visit) {
  for (int shard = 0; shard < kShardCount; ++shard) {
    const fs::path folder = ShardFolder(blob_folder, shard);
    std::error_code code, ignored;
    if (!fs::exists(folder, ignored)) continue;
    for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
      if (entry->is_regular_file(ignored)) visit(*entry, KindOfBlobFile(entry->path().filename().string()));
    if (code)
      return Fail(ErrorCode::kStorage, "the folder " + folder.string() + " cannot be read: " + code.message(),
                  "Check the disk and the permissions of the folder.");
  }
  return {};
}

Result<NamedBlobs> LoadNamedBlobs(Connection& connection) {
  NamedBlobs named;
  RIGCAL_TRY(connection.Read([&] {
    return connection.Load("the names of stored files", [&]() -> Status {
      Query derived(connection, kDerived);
      while (derived.Step()) named.try_emplace(derived.IdAt<Digest>(0));
      Query inputs(connection, kInputs);
      while (inputs.Step()) named[inputs.IdAt<Digest>(0)] = {true, inputs.Int(1) != 0};
      return {};
    });
  }));
  return named;
}

Result<std::vector<NamedPayload>> LoadPayloadsOf(Connection& connection, const Digest& digest) {
  std::vector<NamedPayload> payloads;
  RIGCAL_TRY(connection.Load("the sessions of " + digest.str(), [&]() -> Status {
    Query query(connection,
                "SELECT s.robot_id, s.session_id, p.path FROM payload p "
                "JOIN payload_held h ON h.session_number = p.session_number AND h.idx = p.idx "
                "JOIN session s ON s.number = p.session_number WHERE p.digest = ? "
                "ORDER BY s.robot_id, s.number, p.path");
    query.Bind(digest);
    while (query.Step()) payloads.push_back({query.IdAt<RobotId>(0), query.IdAt<SessionId>(1), query.Text(2)});
    return {};
  }));
  return payloads;
}

std::string TextOf(const std::vector<NamedPayload>& payloads) {
  if (payloads.empty()) return "of no session";
  const NamedPayload& first = payloads.front();
  const std::string text =
      first.path + " of session " + first.session.str().substr(0, kDigitsShown) + " of robot " + first.robot.str();
  return payloads.size() == 1 ? text : text + " and " + std::to_string(payloads.size() - 1) + " more";
}

}  // namespace rigcal::storage
