// Content-addressed files: what lies in their folder, and which of them the rows of a database name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "storage/database/connection.h"

namespace rigcal::storage {

enum class BlobFileKind {
  kBlob,      // named by a digest
  kSetAside,  // "<digest>.damaged", "<digest>.damaged.2", ...
  kHalf,      // was being written when a process ended
  kForeign,   // not of rigcal
};
// By its name alone.
[[nodiscard]] BlobFileKind KindOfBlobFile(const std::string& name);

// Every regular file of the shards of `blob_folder`, in no order. What comes or goes meanwhile may be missed. The error
// names a shard that cannot be read.
[[nodiscard]] Status ForEachBlobFile(
    const std::filesystem::path& blob_folder,
    const std::function<void(const std::filesystem::directory_entry&, BlobFileKind)>& visit);

struct NamedBlob {
  bool is_input = false;       // receipted, and nowhere else: it cannot be made again
  bool is_known_lost = false;  // that the disk has not kept it is in the rows already
};
using NamedBlobs = std::map<Digest, NamedBlob>;

// Payloads that have a receipt; pictures and documents of edges; pictures of what detectors found.
[[nodiscard]] Result<NamedBlobs> LoadNamedBlobs(Connection& connection);

// A payload with that content.
struct NamedPayload {
  RobotId robot;
  SessionId session;
  std::string path;
};
// By robot, session and path; only those that have a receipt.
[[nodiscard]] Result<std::vector<NamedPayload>> LoadPayloadsOf(Connection& connection, const Digest& digest);
// "left/03.jpg of session 0123456789abcdef of robot mapper-01", of the first of them; "and 2 more".
[[nodiscard]] std::string TextOf(const std::vector<NamedPayload>& payloads);

}  // namespace rigcal::storage
