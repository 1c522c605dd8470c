// One line per refusal and per receipt, and the figures of both.
#pragma once

#include <string>

#include "idl/convert.h"
#include "server/base/log.h"

namespace rigcal::dds {

// A warning: `said`, then the error as a sentence.
void LogRefusal(LogSubject subject, const std::string& said, const Error& error);
// What was on disk before the receipt went out: one that closes is told always, the others with --verbose.
void LogReceipt(LogSubject subject, wire::ReceiptState state, const std::string& text);
// "closed", "need_manifest", "receiving", "refused".
[[nodiscard]] std::string NameOf(wire::ReceiptState state);

}  // namespace rigcal::dds
