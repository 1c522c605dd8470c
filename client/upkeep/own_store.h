// The store of a data folder, to change who may use the server over HTTP. A rigcald may serve meanwhile.
#pragma once

#include <iosfwd>
#include <string>

#include "server/model/approval/standing.h"
#include "storage/store.h"

namespace rigcal::client {

// kConflict: the folder is another user's.
[[nodiscard]] Status CheckOwner(const std::string& folder);

// That of `folder`, or whose rows RIGCAL_STORE names; a new one where there is none yet, which `err` is told. kConflict
// where the folder is another user's: files that this one makes there would keep its rigcald out. kUnsupported where it
// is of another version.
[[nodiscard]] Result<storage::Store> OpenOwnStore(const std::string& folder, std::ostream& err);

// Now, by `given` or, where that is empty, by who is at this terminal: of sudo, who called it.
[[nodiscard]] Word WordOf(const std::string& given);

}  // namespace rigcal::client
