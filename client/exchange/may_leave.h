// Which revision leaves for other programs, and whether it may: robots run by what leaves here, so it is by the words
// of docs/approval.md.
#pragma once

#include <optional>
#include <string>

#include "client/text/document.h"
#include "server/base/result.h"

namespace rigcal::client {

// `shown`: an answer to `show` of the newest revision. The number of the one to take: that which is in use; absent:
// none is.
[[nodiscard]] std::optional<std::int64_t> RevisionInUse(const Document& shown);

struct Leave {
  std::string
      standing;       // "in use", "superseded", "candidate, not approved", "fail, not approved": for the file's comment
  std::string doubt;  // a sentence for people; empty: none
};
// Of the revision in `shown`. Good: in use, or superseded by a newer one and asked for by its number. kConflict of all
// others, with why and the command that approves it, unless `even_if_not_approved`: then the doubt says it. Of a server
// that knows no approvals a verdict of pass or warn is good. `may_be_overruled`: the verb has that option, and the
// error offers it.
[[nodiscard]] Result<Leave> MayLeave(const Document& shown, bool even_if_not_approved, bool may_be_overruled = true);

}  // namespace rigcal::client
