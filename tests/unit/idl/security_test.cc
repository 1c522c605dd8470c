#include "idl/security.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "client/identity/authority.h"
#include "client/identity/permissions.h"
#include "idl/presence.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::wire {
namespace {

using testing::HasSubstr;
using Status = rigcal_wire_RobotStatus;

constexpr std::chrono::milliseconds kMet{20'000}, kNotMet{2'500};
const RobotId kA("a"), kB("b");

// One authority, a server and two robots; the server is apart, so that they meet over the network as two processes do.
class SecurityTest : public testing::Test {
 protected:
  SecurityTest() {
    const Stamp now = SystemClock().Now(), until{now.ns + 3'600'000'000'000};
    for (const RobotId& robot : {kA, kB})
      EXPECT_TRUE(authority_.Issue(IdentityHolder::kRobot, robot.str(), now, until, false));
    EXPECT_TRUE(authority_.Issue(IdentityHolder::kOperator, "ada", now, until, false));
  }
  [[nodiscard]] ParticipantOptions With(const std::filesystem::path& identity, bool apart = false) const {
    ParticipantOptions options;
    options.domain = 31;
    options.tag = tag_;
    options.apart = apart;
    options.identity = identity;
    return options;
  }
  [[nodiscard]] ParticipantOptions Server() const { return With(folder_.path() / "fleet" / "server", true); }
  [[nodiscard]] ParticipantOptions Robot(const RobotId& robot) const {
    return With(authority_.FolderOf(IdentityHolder::kRobot, robot.str()));
  }

  const TempFolder folder_;
  const std::string tag_ = "security-" + std::to_string(std::random_device()());
  client::Authority authority_ = client::Authority::Make(folder_.path() / "fleet", SystemClock().Now()).value();
};

TEST_F(SecurityTest, RobotWritesAsItselfAlone) {
  const auto server = Participant::Open(Server());
  ASSERT_TRUE(server) << server.error().what;
  const auto robot = Participant::Open(Robot(kA)).value();
  EXPECT_EQ(robot.AskPartition(), "robot/a");
  auto headers = Reader<rigcal_wire_SessionHeader>::Open(*server, {kAllRobotsPartition}).value();
  auto own = Writer<rigcal_wire_SessionHeader>::Open(robot, {RobotPartition(kA)}).value();
  ASSERT_TRUE(own.WaitForReader(kMet));
  rigcal_wire_SessionHeader header{};
  header.robot_id[0] = 'a';
  ASSERT_TRUE(own.Write(header));
  ASSERT_TRUE(own.WaitForAcks(kMet));
  const auto taken = headers.Take(1, [](const auto&, const SampleOrigin& origin) {
    EXPECT_THAT(origin.partitions, testing::ElementsAre("robot/a"));
  });
  EXPECT_EQ(taken.value(), 1);
  const auto other = Writer<rigcal_wire_SessionHeader>::Open(robot, {RobotPartition(kB)});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().what,
            "the identity of robot a does not let it write rigcal/SessionHeader in partition robot/b");
  EXPECT_FALSE(Reader<Status>::Open(robot, {kAllRobotsPartition})) << "it reads of no other";
  EXPECT_FALSE(Writer<Status>::Open(robot, {RobotPartition(kA)})) << "and says nothing as a server does";
}

TEST_F(SecurityTest, StrangersMeetNobody) {
  const auto server = Participant::Open(Server()).value();
  auto statuses = Writer<Status>::Open(server, {RobotPartition(kA)}).value();
  auto headers = Reader<rigcal_wire_SessionHeader>::Open(server, {kAllRobotsPartition}).value();
  const auto stranger = Participant::Open(With({})).value();
  auto of_stranger = Writer<rigcal_wire_SessionHeader>::Open(stranger, {RobotPartition(kA)}).value();
  auto eavesdropper = Reader<Status>::Open(stranger, {kAllRobotsPartition}).value();
  EXPECT_FALSE(of_stranger.WaitForReader(kNotMet));
  EXPECT_EQ(eavesdropper.MatchedWriters(), 0);
  EXPECT_EQ(headers.MatchedWriters(), 0);
  EXPECT_EQ(statuses.MatchedReaders(), 0);
}

TEST_F(SecurityTest, IdentityOfAnotherAuthorityMeetsNobody) {
  const auto server = Participant::Open(Server()).value();
  auto headers = Reader<rigcal_wire_SessionHeader>::Open(server, {kAllRobotsPartition}).value();
  auto foreign = client::Authority::Make(folder_.path() / "other", SystemClock().Now()).value();
  const Stamp now = SystemClock().Now();
  ASSERT_TRUE(foreign.Issue(IdentityHolder::kRobot, "a", now, {now.ns + 3'600'000'000'000}, false));
  const auto robot = Participant::Open(With(foreign.FolderOf(IdentityHolder::kRobot, "a"))).value();
  auto writer = Writer<rigcal_wire_SessionHeader>::Open(robot, {RobotPartition(kA)}).value();
  EXPECT_FALSE(writer.WaitForReader(kNotMet));
  EXPECT_EQ(headers.MatchedWriters(), 0);
}

TEST_F(SecurityTest, RevokedIsRefusedByWhoHasTheList) {
  ASSERT_TRUE(authority_.Revoke(IdentityHolder::kRobot, "a", SystemClock().Now()));
  std::filesystem::remove(authority_.FolderOf(IdentityHolder::kRobot, "a") / identity_files::kRevoked);
  const auto server = Participant::Open(Server()).value();
  auto headers = Reader<rigcal_wire_SessionHeader>::Open(server, {kAllRobotsPartition}).value();
  const auto robot = Participant::Open(Robot(kA)).value();
  auto writer = Writer<rigcal_wire_SessionHeader>::Open(robot, {RobotPartition(kA)}).value();
  EXPECT_FALSE(writer.WaitForReader(kNotMet));
  EXPECT_EQ(headers.MatchedWriters(), 0);
}

TEST(OperatorPartition, SaysWhoAndWhatTheyMay) {
  const auto ada = OperatorOfPartition(OperatorPartition({"ada", Role::kTechnician}));
  ASSERT_TRUE(ada);
  EXPECT_EQ(ada->name, "ada");
  EXPECT_EQ(ada->role, Role::kTechnician);
  for (const char* other : {"operator/*", "operator/ada", "operator/boss/ada", "operator/admin/", "operator/admin/*",
                            "operator/admin/a/b", "robot/ada", "operator"})
    EXPECT_FALSE(OperatorOfPartition(other)) << other;
}

TEST(IdentityFolder, OneThatMayBeMissingIsTakenWhereItIsThere) {
  const TempFolder folder;
  const std::filesystem::path place = folder.path() / "dds", wished = "-" + place.string();
  EXPECT_EQ(IdentityFolder(wished), "");
  EXPECT_EQ(IdentityFolder(place), place) << "one that is demanded is missed";
  std::filesystem::create_directory(place);
  EXPECT_EQ(IdentityFolder(wished), place);
  ParticipantOptions options;
  options.identity = wished;
  EXPECT_FALSE(Participant::Open(options)) << "an empty one is no reason to be open to all";
}

// Until there is one, or the time is over.
std::vector<ServerName> Listed(ServerList& list, std::chrono::milliseconds within) {
  std::vector<ServerName> servers;
  const auto deadline = std::chrono::steady_clock::now() + within;
  while (servers.empty() && std::chrono::steady_clock::now() < deadline) servers = list.Load().value();
  return servers;
}

TEST_F(SecurityTest, ServerIsBelievedByItsPermissions) {
  const auto ada = Participant::Open(With(authority_.FolderOf(IdentityHolder::kOperator, "ada"))).value();
  EXPECT_EQ(ada.AskPartition(), "operator/approver/ada");
  EXPECT_FALSE(Writer<rigcal_wire_Request>::Open(ada, {"operator/admin/ada"})) << "nor in that of a higher role";
  auto list = ServerList::Open(ada).value();
  ParticipantOptions options = Robot(kA);
  options.apart = true;
  options.user_data = WriteServerName({"f", ServerState::kServes, {1}, "", 0, ""});
  {
    const auto liar = Participant::Open(options).value();  // a robot that says that it serves
    EXPECT_FALSE(ProveServer(liar));
    EXPECT_TRUE(Listed(list, kNotMet).empty());
  }
  options = Server();
  options.user_data = WriteServerName({"0", ServerState::kServes, {1}, "", 0, ""});
  const auto server = Participant::Open(options).value();
  const auto proof = ProveServer(server).value();
  const auto servers = Listed(list, kMet);
  ASSERT_EQ(servers.size(), 1U);
  EXPECT_EQ(servers.front().id, "0");
  ASSERT_TRUE(server.Tell(WriteServerName({"0", ServerState::kWaits, {1}, "", 0, ""}))) << "and may tell anew";
}

TEST_F(SecurityTest, FilesThatDoNotBelongTogetherAreRefused) {
  const auto file = [&](const RobotId& robot) {
    return authority_.FolderOf(IdentityHolder::kRobot, robot.str()) / identity_files::kPermissions;
  };
  std::filesystem::copy_file(file(kB), file(kA), std::filesystem::copy_options::overwrite_existing);
  const auto refused = Participant::Open(Robot(kA));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("does not take the identity in "));
  EXPECT_THAT(refused.error().what, HasSubstr("Subject name"));
}

// Every identity has a key, so its holder can sign what it likes: here that it may write and read as the server does,
// with whatever of its own folder is in the way replaced.
TEST_F(SecurityTest, NobodyGrantsItselfMore) {
  const auto folder = authority_.FolderOf(IdentityHolder::kRobot, "a");
  const auto text = [&](const char* file) { return ReadFile(folder / file, 1 << 20).value(); };
  const auto own = client::Signer::Read({text(identity_files::kKey), text(identity_files::kCertificate)}, "its own");
  std::string forged = client::PermissionsText(ReadIdentity(folder, SystemClock().Now()).value());
  for (std::size_t at = 0; (at = forged.find("robot/a<")) != std::string::npos;) forged.replace(at, 7, "robot/*");
  ASSERT_TRUE(WriteDurably(folder / identity_files::kPermissions, own->Sign(forged).value()));
  EXPECT_FALSE(Participant::Open(Robot(kA)));
  ASSERT_TRUE(WriteDurably(folder / identity_files::kPermissionsAuthority, text(identity_files::kAuthority)));
  ASSERT_TRUE(WriteDurably(folder / identity_files::kGovernance, own->Sign(client::GovernanceText()).value()));
  const auto robot = Participant::Open(Robot(kA));
  ASSERT_TRUE(robot) << "it takes what it signed itself: " << robot.error().what;
  const auto server = Participant::Open(Server()).value();
  auto headers = Reader<rigcal_wire_SessionHeader>::Open(server, {kAllRobotsPartition}).value();
  auto as_b = Writer<rigcal_wire_SessionHeader>::Open(*robot, {RobotPartition(kB)}).value();
  EXPECT_FALSE(as_b.WaitForReader(kNotMet)) << "nobody else does";
  EXPECT_EQ(headers.MatchedWriters(), 0);
}

}  // namespace
}  // namespace rigcal::wire
