// What a server that starts tells those who listen: of every robot in the store its newest
// verdict, and the calibration that it is to use.
#pragma once

#include "server/pipeline/step.h"

namespace rigcal::pipeline {

[[nodiscard]] Status AnnounceStored(storage::Store& store, const Announcer& announcer);

}  // namespace rigcal::pipeline
