// What each kind of identity may do on DDS, as the documents that DDS Security reads (idl/README.md says who writes and
// reads what). Pure.
#pragma once

#include <string>

#include "server/base/identity/dds_identity.h"

namespace rigcal::client {

// What holds for all: nobody without an identity is met; discovery and every topic are encrypted; who writes or reads
// needs a grant for it.
[[nodiscard]] std::string GovernanceText();
// The grant of one identity, for as long as its certificate is good; everything else is denied.
[[nodiscard]] std::string PermissionsText(const DdsIdentity& identity);

}  // namespace rigcal::client
