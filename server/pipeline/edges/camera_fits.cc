#include "server/pipeline/edges/camera_fits.h"

#include "server/base/log.h"
#include "server/formats/edges/camera_fit.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {
namespace {

Result<CameraFit> LoadFit(const storage::Store& store, const Digest& digest) {
  RIGCAL_ASSIGN(const std::string text, storage::LoadBlob(store.blobs(), digest, formats::kCameraFitBytesMax));
  return formats::ReadCameraFit(text);
}

}  // namespace

Status AppendFits(storage::Store& store, const std::vector<CameraFit>& fits, Edge& edge) {
  for (const CameraFit& fit : fits) {
    if (fit.views.empty()) continue;
    RIGCAL_ASSIGN(const Digest digest, storage::AppendBlob(store.blobs(), formats::WriteCameraFit(fit)));
    edge.evidence.push_back({fit.camera.str() + ": corners and residuals", fit.camera, CaptureId(), digest,
                             std::string(formats::kCameraFitSuffix)});
  }
  return {};
}

Result<std::vector<report::CameraReport>> LoadFits(storage::Store& store,
                                                   const std::vector<report::FitChoice>& choices) {
  std::vector<report::CameraReport> cameras;
  for (const report::FitChoice& choice : choices) {
    auto fit = LoadFit(store, choice.document);
    if (!fit && fit.error().code == ErrorCode::kUnreachable) return Fail(fit.error());
    if (fit && fit->camera == choice.camera)
      cameras.push_back({std::move(*fit), choice.edge, choice.document, SessionId()});
    else if (!fit)
      LogError({fit.error().code, "camera " + choice.camera.str() + ": " + fit.error().what, fit.error().cure});
  }
  return cameras;
}

}  // namespace rigcal::pipeline
