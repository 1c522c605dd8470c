// A store with at least one row in each table but the queues.
#pragma once

#include "storage/store.h"

namespace rigcal::storage {

// Fails the test that runs where it cannot.
void FillEveryTable(Store& store);

}  // namespace rigcal::storage
