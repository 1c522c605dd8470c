#include "server/calib/camera/layout_diagnosis.h"

#include <algorithm>
#include <string>

#include "server/calib/core/diagnoses.h"

namespace rigcal::calib {
namespace {

constexpr const char* kLayoutCode = "board_layout";

}  // namespace

Diagnosis OtherLayout(const SensorId& camera, const Target& board, const std::vector<CaptureId>& captures) {
  return {kLayoutCode,
          "In " + std::to_string(captures.size()) + (captures.size() == 1 ? " capture of " : " captures of ") +
              camera.str() + " (" + NamesOf(captures) + ") the markers of target '" + board.id.str() +
              "' lie as in the layout " +
              (board.legacy_layout ? "of OpenCV 4.6 and later" : "before OpenCV 4.6 (legacy)") +
              ", which is not the one of its description; these pictures take no part.",
          std::string("Set legacy_layout: ") + (board.legacy_layout ? "false" : "true") + " for target '" +
              board.id.str() + "' in session.yaml, and push the session again."};
}

void PutLayoutFirst(std::vector<Diagnosis>& diagnoses) {
  std::stable_partition(diagnoses.begin(), diagnoses.end(),
                        [](const Diagnosis& diagnosis) { return diagnosis.code == kLayoutCode; });
}

}  // namespace rigcal::calib
