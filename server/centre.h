// Sites and their centre, joined to the rest of this server. The centre's side: what sites send on is taken in as if it
// had come over DDS, and answered once it is on disk.
#pragma once

#include "server/dds/tell/receipt_watches.h"
#include "server/http/logins/logins.h"
#include "server/service_relay.h"
#include "server/sites/forwarder.h"
#include "storage/store_place.h"

namespace rigcal {

// Answers what http/forwarded.h is asked (docs/api.md, forward). The relay and the watches outlive it.
[[nodiscard]] http::AnswerSite AnswerSites(const storage::StorePlace& place, const ServiceRelay& relay,
                                           dds::ReceiptWatches& watches);

// The site's side: what is approved at the centre is ordered here by way of the relay, which outlives it.
[[nodiscard]] sites::Forwarder::Options ForwardingOf(const storage::StorePlace& place,
                                                     const sites::CentreAddress& centre, Vitals& vitals,
                                                     const ServiceRelay& relay);
// The same callbacks, but that sites hear what the service receipts, and the forwarder, if this is a site, of what may
// have become whole here.
[[nodiscard]] dds::Callbacks WithSites(dds::Callbacks callbacks, dds::ReceiptWatches& watches,
                                       sites::Forwarder& forwarder);

}  // namespace rigcal
