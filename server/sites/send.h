// One session or batch from this store to the centre.
#pragma once

#include "server/sites/centre_link.h"
#include "storage/store.h"

namespace rigcal::sites {

// Returns once the centre has all of it on its disk; what it had before is not sent. Errors: centre_link.h. Of a
// session's files those that this disk has not kept count as lost from then on (storage/files/lost_blobs.h): kStorage
// names the first, and whoever pushes the session again sends them.
[[nodiscard]] Status SendSession(storage::Store& store, const CentreLink& link, const SessionId& session);
[[nodiscard]] Status SendBatch(storage::Store& store, const CentreLink& link, const BatchId& batch);

}  // namespace rigcal::sites
