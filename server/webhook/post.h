// One alert, sent to one receiver by HTTP.
#pragma once

#include <atomic>
#include <string>

#include "server/base/result.h"
#include "server/base/stamp.h"
#include "server/model/robots/alert.h"

namespace rigcal::webhook {

struct Receiver {
  std::string url;     // http:// or https://
  std::string secret;  // what it knows the sender by
};
// kInvalidInput for an address that is neither, or that names a user or a password; for a secret of fewer than 16
// bytes.
[[nodiscard]] Status CheckReceiver(const Receiver& receiver);

inline constexpr long kConnectMax_ms = 5'000, kPostMax_ms = 15'000;

// "sha256=" and the HMAC of "<timestamp_s>.<body>" by the secret.
[[nodiscard]] std::string SignatureOf(const std::string& secret, std::int64_t timestamp_s, const std::string& body);

// POSTs the body with X-Rigcal-Id, X-Rigcal-Timestamp (seconds since 1970, `now`) and X-Rigcal-Signature. The HTTP
// status of the answer, whatever it is; redirects are not followed. kUnreachable where none came in time, or `stopping`
// was set meanwhile. Any thread.
[[nodiscard]] Result<int> Post(const Receiver& receiver, const Alert& alert, Stamp now,
                               const std::atomic<bool>& stopping);

}  // namespace rigcal::webhook
