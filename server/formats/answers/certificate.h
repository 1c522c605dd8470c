// The document of the verb `certificate` (docs/api.md): all that the certificate of a revision says.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/model/certificate.h"

namespace rigcal::formats {

[[nodiscard]] std::string WriteCertificate(const Certificate& certificate);
// Bounded, validated: the spans of each row make up the columns of its table. The error names the field.
[[nodiscard]] Result<Certificate> ReadCertificate(std::string_view text);

}  // namespace rigcal::formats
