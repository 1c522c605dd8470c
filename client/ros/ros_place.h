// Where a robot's ROS 2 is on the network.
#pragma once

#include <optional>
#include <string>

#include "idl/dds.h"

namespace CLI {
class App;
}

namespace rigcal::client {

inline constexpr int kRosDomainMax = 230;  // as of Rigcal's own domains; ROS 2 itself goes to 232

// As words of a command line.
struct RosPlace {
  std::optional<int> domain = {};  // absent: ROS_DOMAIN_ID
  std::string tag = {};            // DDS discovery tag; programs of ROS 2 have none
};
// --ros-domain and --ros-tag; `place` outlives `verb`.
void AddRosPlace(CLI::App& verb, RosPlace& place);
// What was given, else ROS_DOMAIN_ID, else 0; kInvalidInput where that is no domain.
[[nodiscard]] Result<int> RosDomainOf(const RosPlace& place);
// A participant there, apart from Rigcal's own traffic; the domain as of RosDomainOf.
[[nodiscard]] Result<wire::Participant> OpenRosParticipant(int domain, const std::string& tag);

}  // namespace rigcal::client
