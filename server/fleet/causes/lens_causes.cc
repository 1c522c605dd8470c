// Cameras whose pictures another lens model fits.
#include <map>
#include <string>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

struct OtherLens {
  CameraModel model = CameraModel::kPinholeRadtan;
  double rms_px = 0.0;
  std::optional<double> listed_rms_px = {};  // of the model that the session lists
  const Edge* edge = nullptr;                // that tells it
};

std::optional<OtherLens> OtherLensOf(const EdgeEnd& end) {
  for (const CameraModel model : {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4})
    if (const auto rms_px = end.Figure("rms_as_" + NameOf(model), "_px"))
      return OtherLens{model, *rms_px, end.Figure("rms_as_listed", "_px"), end.edge};
  return std::nullopt;
}

// Of a camera in all its pairs: the lens as the best of them has it.
struct BentCamera {
  OtherLens lens;
  std::vector<EdgeId> edges;
};

std::string NotTo(const OtherLens& lens) {
  return lens.listed_rms_px ? ", not to " + TwoDigits(*lens.listed_rms_px, "px") : "";
}

RootCause WrongLens(const CauseSearch& search, const SensorId& camera, const BentCamera& bent) {
  RootCause cause{CauseKind::kLensModel, {camera}, {}, {}, bent.edges, {}, kPushAgain};
  const Sensor* listed = SensorOf(search.headers, *bent.lens.edge, camera);
  const std::string name = camera.str(), model = NameOf(bent.lens.model);
  cause.trait = model;
  cause.said = {"the lens of " + name + (listed ? " is not " + NameOf(listed->camera_model) : " has another model") +
                    ": as " + model + " it fits to " + TwoDigits(bent.lens.rms_px, "px") + NotTo(bent.lens),
                "Give " + name + " `model: " + model + "` in session.yaml"};
  return cause;
}

}  // namespace

void FindLensModels(CauseSearch& search) {
  const std::vector<const Edge*> taken = search.Take([](const Edge& edge) {
    return OtherLensOf(EndsOf(edge)[0]).has_value() || OtherLensOf(EndsOf(edge)[1]).has_value();
  });
  std::map<SensorId, BentCamera> cameras;
  for (const Edge* edge : taken)
    for (const EdgeEnd& end : EndsOf(*edge)) {
      const auto lens = OtherLensOf(end);
      if (!lens) continue;
      BentCamera& bent = cameras[end.sensor];
      bent.edges.push_back(edge->id);
      if (bent.lens.edge == nullptr || lens->rms_px < bent.lens.rms_px) bent.lens = *lens;
    }
  for (const auto& [camera, bent] : cameras) search.causes.push_back(WrongLens(search, camera, bent));
}

}  // namespace rigcal::fleet
