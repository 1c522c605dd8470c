// What holds of the documents that were read.
#pragma once

#include "server/formats/documents.h"
#include "tests/fuzz/fuzz.h"

namespace rigcal::fuzz {

inline void CheckUncertainty(const Uncertainty& uncertainty) {
  RequireFinite(uncertainty.Omega, "information");
  RequireFinite(uncertainty.covariance, "covariance");
  RequireFinite(uncertainty.unobservable_basis, "basis");
  for (const BlockVector& block : uncertainty.blocks) RequireFinite(block.d, "block vector");
  for (const Contribution& part : uncertainty.contributions) RequireFinite(part.covariance, "contribution");
}

inline void CheckEdge(const Edge& edge) {
  if (const Status valid = Validate(edge); !valid) Require(false, "an edge is valid", valid.error().what);
  if (edge.state != EdgeState::kGood) return;
  RequireFinite(edge.T_a_b.p_m, "position");
  Require(std::abs(edge.T_a_b.q.norm() - 1.0) < 1e-5, "a quaternion has unit length");
  CheckUncertainty(edge.uncertainty);
}

// What was read is written and read again to the same text.
template <typename Value>
void RequireRoundTrip(const Value& value, std::string (*write)(const Value&), Result<Value> (*read)(std::string_view)) {
  const std::string text = write(value);
  const Result<Value> again = read(text);
  if (!again) Require(false, "what was written can be read", again.error().what);
  Require(write(*again) == text, "a document keeps its bytes", text);
}

}  // namespace rigcal::fuzz
