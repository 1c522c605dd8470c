// The one JSON of everything: the same text goes over DDS, HTTP, into reports, the CLI's --json and golden tests.
// Writers are canonical: keys sorted, shortest round-trip numbers, no NaN or infinity ever (an absent value is null).
// Poses: {"frame_a", "frame_b", "T_a_b": {"p_m": [3], "q_xyzw": [4]}}; matrices: 6 rows of 6, order [x y z rx ry rz].
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/model/approval/policy_version.h"
#include "server/model/approval/standing.h"
#include "server/model/cause.h"
#include "server/model/edges/edge.h"
#include "server/model/graph/graph.h"
#include "server/model/sessions/session.h"
#include "server/model/verdict_basis.h"

namespace rigcal::formats {

// The session's manifest. SessionId = sha256 of WriteManifest's text.
[[nodiscard]] std::string WriteManifest(const Manifest& manifest);
[[nodiscard]] Result<Manifest> ReadManifest(std::string_view text);  // bounded, validated

// An edge, whole.
[[nodiscard]] std::string WriteEdge(const Edge& edge);
[[nodiscard]] Result<Edge> ReadEdge(std::string_view text);

// A file of finished edges for `rigcal push-edges` (docs/edges-format.md):
// {"format": 1, "measured_at"?, "edges": [{"frame_a", "frame_b", "T_a_b", "information" | "covariance", "method"?,
// ...}]}. Ids are assigned (AssignPushedIds). The error names the edge by its position and field.
[[nodiscard]] Result<std::vector<Edge>> ReadEdgeFile(std::string_view text, const RobotId& robot);

// A revision's canonical document: sensors, edges, residuals, verdict, causes; neither number nor time, and the same
// bytes for the same edges whatever the order in which they arrived. Format 2 refers to its edges (edge_reference.h).
struct RevisionInput {
  RobotId robot;
  SensorId reference;
  std::vector<Edge> edges;  // good and failed, sorted by id
  GraphSolution solution;
  Verdict verdict;
  std::optional<PolicyInForce> policy = {};  // that judged it; absent: it is from before there were any
  std::vector<RetiredSensor> retired = {};   // sorted by sensor; in the document only where there is any
  bool whole = true;  // false: of edges what a document of format 2 has, and no more (revisions/whole_revision.h)
  std::vector<Cause> causes = {};  // those that fail most pairs first
  VerdictBasis basis = {};         // of `verdict`; in the document only where it says something
};
// In format 2, for which `input` need not be whole.
[[nodiscard]] std::string WriteRevisionDocument(const RevisionInput& input);
// Format 1: the same with every detail of the edges but block vectors. `input` must be whole.
[[nodiscard]] std::string WriteWholeRevisionDocument(const RevisionInput& input);
// Back to values, of either format; edges without block vectors.
[[nodiscard]] Result<RevisionInput> ReadRevisionDocument(std::string_view text);

}  // namespace rigcal::formats
