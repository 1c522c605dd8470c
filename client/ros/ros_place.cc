#include "client/ros/ros_place.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdlib>

namespace rigcal::client {

void AddRosPlace(CLI::App& verb, RosPlace& place) {
  verb.add_option("--ros-domain", place.domain,
                  "The domain of the robot's ROS 2, 0..230 (default: ROS_DOMAIN_ID, else 0)")
      ->type_name("N")
      ->check(CLI::Range(0, kRosDomainMax));
  verb.add_option("--ros-tag", place.tag,
                  "DDS discovery tag of the robot's ROS 2, if its Cyclone DDS has one (default: none)")
      ->type_name("NAME");
}

Result<int> RosDomainOf(const RosPlace& place) {
  if (place.domain) return *place.domain;
  const char* variable = std::getenv("ROS_DOMAIN_ID");
  const std::string text = variable == nullptr ? "" : variable;
  if (text.empty()) return 0;
  int number = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ptr == end && read.ec == std::errc() && number >= 0 && number <= kRosDomainMax) return number;
  return Fail(ErrorCode::kInvalidInput,
              "ROS_DOMAIN_ID is '" + text + "', and no number from 0 to " + std::to_string(kRosDomainMax),
              "Set it to what the robot's other programs have, or give --ros-domain.");
}

Result<wire::Participant> OpenRosParticipant(int domain, const std::string& tag) {
  wire::ParticipantOptions options;
  options.domain = domain;
  options.tag = tag;
  options.as_given = true;
  options.apart = true;  // Rigcal's own traffic may be in the same domain under another tag
  return wire::Participant::Open(options);
}

}  // namespace rigcal::client
