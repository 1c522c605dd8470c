// The document of a camera's fit (docs/api.md): what an edge keeps of its cameras, beside its pictures.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/formats/json/json_field.h"
#include "server/formats/json/json_writer.h"
#include "server/model/sensors/camera_fit.h"

namespace rigcal::formats {

// As the suffix of an Evidence: its blob is such a document.
inline constexpr std::string_view kCameraFitSuffix = "fit";
inline constexpr std::size_t kCameraFitBytesMax = 64u << 20;

// Places to a hundredth, residuals to a thousandth of a pixel.
[[nodiscard]] std::string WriteCameraFit(const CameraFit& fit);
[[nodiscard]] Result<CameraFit> ReadCameraFit(std::string_view text);  // bounded, validated
// The same as members of an object that is written or read.
void WriteCameraFitMembers(JsonWriter& out, const CameraFit& fit);
[[nodiscard]] CameraFit ReadCameraFitMembers(const JsonField& root);
// Model, distortion, and fx fy cx cy of a lens, likewise.
void WriteLensMembers(JsonWriter& out, const CameraIntrinsics& lens);
[[nodiscard]] CameraIntrinsics ReadLensMembers(const JsonField& field);

}  // namespace rigcal::formats
