// READ: how far things are, without a clock in it: the same state gives the same bytes, so that a page may ask often.
#pragma once

#include <string>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// The document of verb `live` (docs/api.md): of one robot, or of all if `robot` is empty.
[[nodiscard]] Result<std::string> LiveDocument(storage::Store& store, const RobotId& robot);

}  // namespace rigcal::pipeline
