// Lenses that bend beyond their model, in JSON: in the estimate of a session, and in a revision (docs/api.md, show).
#pragma once

#include <string_view>
#include <vector>

#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/sensors/lens_misfit.h"

namespace rigcal::formats {

// A list; "trial" is only there where lens models were tried.
void WriteMisfits(JsonWriter& out, std::string_view key, const std::vector<LensMisfit>& misfits);
[[nodiscard]] std::vector<LensMisfit> ReadMisfits(const JsonField& field);
// A list "pupil_shifts", where there are any.
void WritePupilShifts(JsonWriter& out, const std::vector<PupilShift>& shifts);
[[nodiscard]] PupilShift ReadPupilShift(const JsonField& field);

}  // namespace rigcal::formats
