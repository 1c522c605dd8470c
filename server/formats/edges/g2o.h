// .g2o pose graphs: EDGE_SE3:QUAT, VERTEX_SE3:QUAT (optional), FIX, '#' comments. g2o's error is about D e with
// D = diag(1,1,1,1/2,1/2,1/2), so Omega_ours = D Omega_g2o D. Vertex n becomes sensor "n", or what a comment
// "# vertex n is NAME" before it says, as WriteG2o writes them.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/model/graph/graph.h"

namespace rigcal::formats {

struct G2oFile {
  std::vector<Edge> edges;                 // ids assigned, method "g2o", source given; in the order of the file
  std::map<SensorId, Se3> T_world_vertex;  // if the file has vertices
  SensorId fixed;                          // the first FIX line's vertex; empty: none
};
// Indefinite, non-finite or asymmetric information and non-unit quaternions (beyond 1e-3; nearer ones are normalised)
// are refused; the error names line and edge; of many that are indefinite it says how many, and the first three. The
// same pair may be measured several times.
[[nodiscard]] Result<G2oFile> ReadG2o(std::string_view text, const RobotId& robot);
// The good edges in their order, poses of known sensors as vertices, the reference as FIX. A pose that is known in part
// stands as it was held, after a comment for each direction that was not measured. Every number is read back as it was,
// bit by bit. Names that are all whole numbers stay; else vertices count the sensors, and comments name them. kNotFound
// without a good edge.
[[nodiscard]] Result<std::string> WriteG2o(const std::vector<Edge>& edges, const std::vector<SensorPose>& poses,
                                           const SensorId& reference);
[[nodiscard]] Matrix6d InformationFromG2o(const Matrix6d& Omega_g2o);
[[nodiscard]] Matrix6d InformationToG2o(const Matrix6d& Omega);

}  // namespace rigcal::formats
