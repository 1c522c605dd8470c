// What happened and who is still to be told: alerts enter in the transaction in which it happens, and wait for each
// receiver until that has them. Receivers are told of what happens from when they were named on.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/alerts/alert_body.h"
#include "server/model/robots/alert.h"
#include "storage/store.h"

namespace rigcal::storage {

// Call inside the Write of what happened.
[[nodiscard]] Status AppendAlert(Store& store, const formats::AlertDraft& draft);
// Whether there is one of that robot, kind and subject.
[[nodiscard]] Result<bool> HasAlert(Store& store, const RobotId& robot, const std::string& kind,
                                    const std::string& subject);

// These addresses, and those of other servers that are there (work/servers.h), and no others, are told from `now` on.
// What waits for others waits on. Of these all is tried at once.
[[nodiscard]] Status SetReceivers(Store& store, const std::vector<std::string>& urls, Stamp now);

// What is to be sent to the receiver next: of each robot the oldest that waits, of these the oldest that may be tried
// by `now`, or only in more than a day, as the clock was set back since. Not what another server has claimed.
[[nodiscard]] Result<std::optional<WaitingAlert>> LoadNextAlert(Store& store, const std::string& url, Stamp now);
// Where several servers send: it is this one's to send for so long. False: another one's, or it waits no more.
[[nodiscard]] Result<bool> ClaimAlert(Store& store, const std::string& url, std::int64_t number,
                                      std::chrono::milliseconds time);
// The receiver answered with `http_status`, 200 to 299. It waits no more; a no-op if it did not.
[[nodiscard]] Status MarkDelivered(Store& store, const std::string& url, std::int64_t number, int http_status,
                                   Stamp now);
// It was tried once more in vain, is to be tried again then, and `error` says why.
[[nodiscard]] Status NoteAttempt(Store& store, const std::string& url, std::int64_t number, const std::string& error,
                                 Stamp next_try_at);

// The address without '?' and what follows.
[[nodiscard]] std::string ShownUrl(const std::string& url);
// By address: those that are told, and those for which something waits.
[[nodiscard]] Result<std::vector<ReceiverState>> LoadReceivers(Store& store);

}  // namespace rigcal::storage
