// Times in certificates and lists of OpenSSL. For server/base/identity/*.cc only.
#pragma once

#include <openssl/asn1.h>

#include "server/base/stamp.h"

namespace rigcal {

// To the second; zero where it is no time.
[[nodiscard]] Stamp StampOfTime(const ASN1_TIME* time);

}  // namespace rigcal
