#include "client/identity/permissions.h"

#include <vector>

#include "idl/dds.h"
#include "idl/security.h"

namespace rigcal::client {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kHead = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<dds>";
constexpr const char* kEveryDomain = "<domains><id_range><min>0</min><max>230</max></id_range></domains>";

template <typename... Types>
Names TopicsOf() {
  return {wire::InfoOf<Types>().name...};
}

Names Pushed() {
  return TopicsOf<rigcal_wire_SessionHeader, rigcal_wire_Manifest, rigcal_wire_Chunk, rigcal_wire_PairwiseResult>();
}
Names Told() {
  return TopicsOf<rigcal_wire_Receipt, rigcal_wire_Event, rigcal_wire_Calibration, rigcal_wire_RobotStatus>();
}
Names Runs() { return TopicsOf<rigcal_wire_CalibrationInUse>(); }
Names Asked() { return TopicsOf<rigcal_wire_Request>(); }
Names Answered() { return TopicsOf<rigcal_wire_Reply>(); }
Names Shown() { return TopicsOf<rigcal_wire_Event>(); }

std::string Listed(const std::string& all, const std::string& one, const Names& names) {
  std::string text = "<" + all + ">";
  for (const std::string& name : names) text += "<" + one + ">" + name + "</" + one + ">";
  return text + "</" + all + ">";
}

// `act`: "publish" or "subscribe"; an endpoint may have any of these partitions and no other.
std::string Grant(const std::string& act, const Names& topics, const Names& partitions) {
  return "<" + act + ">" + Listed("topics", "topic", topics) + Listed("partitions", "partition", partitions) + "</" +
         act + ">\n";
}

// All of them may hear who is a server.
std::string HearsServers() { return Grant("subscribe", Shown(), {wire::kServersPartition}); }

std::string GrantsOfServer() {
  const std::string robots = wire::kAllRobotsPartition, people = wire::kAllOperatorsPartition;
  return Grant("publish", Told(), {robots}) + Grant("publish", Answered(), {people, robots}) +
         Grant("publish", Shown(), {wire::kServersPartition}) + Grant("subscribe", Pushed(), {robots}) +
         Grant("subscribe", Runs(), {robots}) + Grant("subscribe", Asked(), {people, robots}) + HearsServers();
}

std::string GrantsOfRobot(const std::string& id) {
  const std::string own = wire::RobotPartition(RobotId(id));
  return Grant("publish", Pushed(), {own}) + Grant("publish", Runs(), {own}) + Grant("publish", Asked(), {own}) +
         Grant("subscribe", Told(), {own}) + Grant("subscribe", Answered(), {own}) + HearsServers();
}

// A technician pushes for the robot in front of them; what a robot runs it tells itself. Which orders it may give the
// server judges by the partition, which has the role in it.
std::string GrantsOfOperator(const DdsIdentity& identity) {
  const std::string robots = wire::kAllRobotsPartition, own = wire::OperatorPartition({identity.name, identity.role});
  const std::string pushes =
      MayActAs(identity.role, Role::kTechnician) ? Grant("publish", Pushed(), {robots}) : std::string();
  return pushes + Grant("publish", Asked(), {own}) + Grant("subscribe", Told(), {robots}) +
         Grant("subscribe", Answered(), {own}) + HearsServers();
}

// As DDS spells the subject of the certificate.
std::string SubjectOf(const DdsIdentity& identity) {
  const std::string role = identity.holder == IdentityHolder::kOperator ? ",O=" + NameOf(identity.role) : "";
  return "CN=" + identity.name + role + ",OU=" + NameOf(identity.holder);
}

std::string GrantsOf(const DdsIdentity& identity) {
  switch (identity.holder) {
    case IdentityHolder::kServer:
      return GrantsOfServer();
    case IdentityHolder::kRobot:
      return GrantsOfRobot(identity.name);
    case IdentityHolder::kOperator:
      return GrantsOfOperator(identity);
  }
  return "";
}

}  // namespace

// A submessage is encrypted whole, its number in the stream too, so that nothing is played again; its payload is not
// encrypted twice.
std::string GovernanceText() {
  return std::string(kHead) + "<domain_access_rules><domain_rule>" + kEveryDomain +
         "\n<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
         "<enable_join_access_control>true</enable_join_access_control>\n"
         "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
         "<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
         "<rtps_protection_kind>NONE</rtps_protection_kind>\n"
         "<topic_access_rules><topic_rule><topic_expression>*</topic_expression>\n"
         "<enable_discovery_protection>true</enable_discovery_protection>\n"
         "<enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "<enable_read_access_control>true</enable_read_access_control>\n"
         "<enable_write_access_control>true</enable_write_access_control>\n"
         "<metadata_protection_kind>ENCRYPT</metadata_protection_kind>\n"
         "<data_protection_kind>NONE</data_protection_kind>\n"
         "</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>\n";
}

std::string PermissionsText(const DdsIdentity& identity) {
  return std::string(kHead) + "<permissions><grant name=\"rigcal\">\n<subject_name>" + SubjectOf(identity) +
         "</subject_name>\n<validity><not_before>" + ToIso(identity.not_before) + "</not_before><not_after>" +
         ToIso(identity.not_after) + "</not_after></validity>\n<allow_rule>" + kEveryDomain + "\n" +
         GrantsOf(identity) + "</allow_rule><default>DENY</default></grant></permissions></dds>\n";
}

}  // namespace rigcal::client
