// Errors that leave the server: a client must not look for a full disk at its own side.
#pragma once

#include "server/base/result.h"

namespace rigcal::dds {

// Only errors of storage are changed: "the server's disk: ...".
[[nodiscard]] inline Error ToldToClient(Error error) {
  if (error.code == ErrorCode::kStorage) error.what = "the server's disk: " + error.what;
  return error;
}

}  // namespace rigcal::dds
