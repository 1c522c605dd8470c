// What is approved, rolled back or rejected at the centre is so at the site, too, where the site has worked out the
// same.
#pragma once

#include <functional>
#include <set>

#include "server/sites/centre_link.h"
#include "storage/store.h"

namespace rigcal::sites {

// Gives an order (api.md) as of a person: the document that answers it.
using GivesOrder = std::function<Result<std::string>(const std::string& verb, const std::string& json)>;

// Approves, or rolls back to, for each robot known here, the revision whose document is byte for byte that which is in
// use at the centre, where that was decided there after what is in use here; rejects likewise what is rejected there,
// if no person here decided about it later: in the name of who decided, "at the centre". What this server has not
// worked out (yet) is left alone, as are words older than one of here. Each word is taken over once: what somebody says
// here after that holds, also where the centre's clock is ahead. `told`: digests of which the log has said that.
// kUnreachable: the centre does not answer.
[[nodiscard]] Status TakeOver(storage::Store& store, const CentreLink& link, const GivesOrder& give,
                              std::set<Digest>& told);

}  // namespace rigcal::sites
