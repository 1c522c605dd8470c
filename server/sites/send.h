// One session or batch from this store to the centre.
#pragma once

#include "server/sites/centre_link.h"
#include "storage/store.h"

namespace rigcal::sites {

// Returns once the centre has all of it on its disk; what it had before is not sent. Errors: centre_link.h.
[[nodiscard]] Status SendSession(storage::Store& store, const CentreLink& link, const SessionId& session);
[[nodiscard]] Status SendBatch(storage::Store& store, const CentreLink& link, const BatchId& batch);

}  // namespace rigcal::sites
