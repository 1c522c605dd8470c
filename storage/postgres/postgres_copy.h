// Rows as PostgreSQL reads many at once (COPY ... FROM STDIN, in its binary form). For storage/*.cc only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/database/stored_row.h"

namespace rigcal::storage {

// The lowest `count` bytes, the highest of them first: as numbers travel.
[[nodiscard]] std::string BigEndianOf(std::uint64_t bits, int count);

// For columns of BIGINT, DOUBLE PRECISION, TEXT and BYTEA. Source: PostgreSQL's manual, COPY, "Binary Format".
[[nodiscard]] std::string CopyDataOf(const std::vector<StoredRow>& rows);

}  // namespace rigcal::storage
