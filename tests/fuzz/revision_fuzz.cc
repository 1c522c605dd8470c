#include "tests/fuzz/document_checks.h"

using namespace rigcal;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto revision = formats::ReadRevisionDocument(fuzz::TextOf(data, size));
  if (!fuzz::RequireGoodError(revision)) return 0;
  for (const SensorPose& pose : revision->solution.poses) {
    fuzz::RequireFinite(pose.T_ref_sensor.p_m, "position");
    fuzz::RequireFinite(pose.covariance, "covariance");
    if (pose.measured_part) fuzz::RequireFinite(pose.measured_part->covariance, "covariance of a part");
  }
  for (const Edge& edge : revision->edges)
    if (edge.state == EdgeState::kGood) fuzz::CheckUncertainty(edge.uncertainty);
  fuzz::RequireRoundTrip(*revision, formats::WriteRevisionDocument, formats::ReadRevisionDocument);
  if (revision->whole)
    fuzz::RequireRoundTrip(*revision, formats::WriteWholeRevisionDocument, formats::ReadRevisionDocument);
  return 0;
}
