// DDS Security: a participant with an identity meets only those of the same authority, and each writes and reads what
// its permissions grant. The plugins are Cyclone's own.
#pragma once

#include <dds/dds.h>

#include <filesystem>
#include <optional>
#include <string>

#include "server/base/identity/identity_folder.h"
#include "server/base/result.h"
#include "server/base/role.h"

namespace rigcal::wire {

// Where those who have an identity ask: each operator has a partition of its own, which its permissions alone allow. So
// the partition of a question's writer says who asks, and what they may, as that of a robot's data says which robot it
// is. Without identities anybody may write in them: then they say nothing.
struct Operator {
  std::string name;
  Role role = Role::kViewer;
};
inline constexpr const char* kAllOperatorsPartition = "operator/*";
[[nodiscard]] std::string OperatorPartition(const Operator& who);
// Who is in a partition "operator/<role>/<name>"; nothing of any other.
[[nodiscard]] std::optional<Operator> OperatorOfPartition(const std::string& partition);
// Where servers alone may write: who is heard there is one.
inline constexpr const char* kServersPartition = "server";

// `given`, or else RIGCAL_DDS_IDENTITY; empty: DDS without identities. With '-' before it: the folder if it is there.
[[nodiscard]] std::filesystem::path IdentityFolder(const std::filesystem::path& given);

// Adds to a participant's `qos` what makes it take part as who is in `folder`, and says who that is. The errors of
// ReadIdentity; kUnsupported where Cyclone's security plugins are not installed.
[[nodiscard]] Result<DdsIdentity> Secure(dds_qos_t* qos, const std::filesystem::path& folder);

}  // namespace rigcal::wire
