// Which contents the rows of a database name.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "storage/database/connection.h"

namespace rigcal::storage {

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
