// What a server that starts tells those who listen: the newest calibration of every robot in the store.
#pragma once

#include "server/pipeline/step.h"

namespace rigcal::pipeline {

[[nodiscard]] Status AnnounceStored(storage::Store& store, const Announcer& announcer);

}  // namespace rigcal::pipeline
