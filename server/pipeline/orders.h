// WRITE: what people ask to be changed: (verb, parameters) -> one transaction, then the document of docs/api.md.
#pragma once

#include <string>

#include "server/base/stamp.h"
#include "server/model/order.h"
#include "storage/store.h"

namespace rigcal::pipeline {

[[nodiscard]] bool IsOrder(const std::string& verb);

// What it returns is durable. Carried out twice it is as if it was once, and answered alike.
// restore: `session` (id or its first 8 digits or more), `robot` (optional), `who`, `reason` (optional): the session is
// current, those it repeats or is repeated by are superseded by it. retire: `edge` likewise, `who`, `reason`: the edge
// takes no part from now on. set_policy: policies.h. kNotFound, kConflict (a prefix of several), kInvalidInput name
// what is wrong.
[[nodiscard]] Result<OrderDone> CarryOut(storage::Store& store, const Clock& clock, const std::string& verb,
                                         const std::string& json);

}  // namespace rigcal::pipeline
