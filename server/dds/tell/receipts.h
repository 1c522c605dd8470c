// What clients are told of what they send, with one line of the log per refusal and per receipt, and the figures of
// both.
#pragma once

#include <string>

#include "idl/convert.h"
#include "server/base/log.h"
#include "server/base/result.h"

namespace rigcal::dds {

// A warning: `said`, then the error as a sentence.
void LogRefusal(LogSubject subject, const std::string& said, const Error& error);
// What was on disk before the receipt went out: one that closes is told always, the others with --verbose.
void LogReceipt(LogSubject subject, wire::ReceiptState state, const std::string& text);
// "closed", "need_manifest", "receiving", "refused".
[[nodiscard]] std::string NameOf(wire::ReceiptState state);

// An error that leaves the server: a client must not look for a full disk at its own side. Only errors of storage are
// changed: "the server's disk: ...".
[[nodiscard]] inline Error ToldToClient(Error error) {
  if (error.code == ErrorCode::kStorage) error.what = "the server's disk: " + error.what;
  return error;
}

// Refuses a session or a batch, `subject_id`; `incarnation`: the server's.
[[nodiscard]] wire::Receipt RefusalReceipt(const RobotId& robot, std::string subject_id, std::uint64_t incarnation,
                                           const Error& error);

}  // namespace rigcal::dds
