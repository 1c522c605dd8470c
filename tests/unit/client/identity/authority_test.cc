#include "client/identity/authority.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "client/identity/permissions.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kDay_ns = 86'400'000'000'000;

class AuthorityTest : public testing::Test {
 protected:
  [[nodiscard]] Result<DdsIdentity> New(IdentityHolder holder, const std::string& name, bool renews = false,
                                        std::int64_t for_ns = kDay_ns) {
    return authority_.Issue(holder, name, now_, {now_.ns + for_ns}, renews);
  }
  [[nodiscard]] std::vector<std::string> States() const {
    std::vector<std::string> states;
    const auto issued = authority_.List().value();
    for (const IssuedIdentity& one : issued)
      states.push_back(TextOf(one.identity) + (one.revoked ? " revoked" : " good"));
    return states;
  }
  [[nodiscard]] static std::string Text(const fs::path& file) { return ReadFile(file, 1 << 20).value(); }

  const TempFolder folder_;
  const fs::path place_ = folder_.path() / "fleet";
  const Stamp now_ = SystemClock().Now();
  Authority authority_ = Authority::Make(place_, now_).value();
};

TEST_F(AuthorityTest, FolderOfAnIdentityIsWhole) {
  const DdsIdentity made = New(IdentityHolder::kRobot, "mapper-01").value();
  const auto read = ReadIdentity(authority_.FolderOf(IdentityHolder::kRobot, "mapper-01"), now_);
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(TextOf(*read), "robot mapper-01");
  EXPECT_EQ(read->serial, made.serial);
  EXPECT_EQ(read->not_after.ns / 1'000'000'000, (now_.ns + kDay_ns) / 1'000'000'000);
  EXPECT_TRUE(fs::exists(authority_.FolderOf(IdentityHolder::kRobot, "mapper-01") / identity_files::kRevoked));
  EXPECT_EQ(TextOf(ReadIdentity(place_ / "server", now_).value()), "the server");
}

TEST_F(AuthorityTest, NameHasOneGoodIdentityUnlessItIsRenewed) {
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a"));
  EXPECT_EQ(New(IdentityHolder::kRobot, "a").error().code, ErrorCode::kConflict);
  EXPECT_TRUE(New(IdentityHolder::kOperator, "a")) << "a person may be called as a robot";
  EXPECT_TRUE(New(IdentityHolder::kRobot, "a", true));
  EXPECT_THAT(States(),
              testing::ElementsAre("the server good", "robot a good", "robot a good", "operator a (approver) good"));
}

TEST_F(AuthorityTest, ExpiredOneMayBeFollowed) {
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a", false, -1));
  const fs::path folder = authority_.FolderOf(IdentityHolder::kRobot, "a");
  const auto read = ReadIdentity(folder, now_);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().what, HasSubstr("the identity of robot a in " + folder.string() + " expired at "));
  EXPECT_TRUE(New(IdentityHolder::kRobot, "a"));
  EXPECT_FALSE(ReadIdentity(folder, {now_.ns - 2 * kDay_ns})) << "and none is good before it was made";
}

TEST_F(AuthorityTest, RevokedAreAllOfTheNameAndToldToEveryFolder) {
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a"));
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a", true));
  ASSERT_TRUE(New(IdentityHolder::kOperator, "ada"));
  EXPECT_EQ(authority_.Revoke(IdentityHolder::kRobot, "a", now_).value(), 2);
  EXPECT_EQ(authority_.Revoke(IdentityHolder::kRobot, "a", now_).value(), 0) << "asked twice is asked once";
  EXPECT_EQ(authority_.Revoke(IdentityHolder::kRobot, "b", now_).error().code, ErrorCode::kNotFound);
  EXPECT_THAT(States(), testing::ElementsAre("the server good", "robot a revoked", "robot a revoked",
                                             "operator ada (approver) good"));
  const std::string list = Text(place_ / identity_files::kRevoked);
  EXPECT_EQ(ReadRevoked(list, "list").value().size(), 2U);
  for (const char* one : {"server", "operators/ada", "robots/a"})
    EXPECT_EQ(Text(place_ / one / identity_files::kRevoked), list) << one;
  EXPECT_TRUE(New(IdentityHolder::kRobot, "a")) << "a new one may take its place";
  EXPECT_EQ(Authority::Open(place_).value().List().value().size(), 5U);
}

TEST_F(AuthorityTest, ThereIsOneOfAFolder) {
  EXPECT_EQ(Authority::Make(place_, now_).error().code, ErrorCode::kConflict);
  EXPECT_EQ(Authority::Open(folder_.path() / "none").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(WriteDurably(place_ / "ca.key", "no key"));
  EXPECT_EQ(Authority::Open(place_).error().code, ErrorCode::kInvalidInput);
}

TEST_F(AuthorityTest, NamesThatWouldPassForOthersAreRefused) {
  for (const char* name : {"policy", "rigcald", "*", "a/b", "", "a,OU=operator"})
    EXPECT_FALSE(New(IdentityHolder::kOperator, name)) << name;
  EXPECT_TRUE(New(IdentityHolder::kRobot, std::string(64, 'r'))) << "as long as names may be";
  EXPECT_FALSE(New(IdentityHolder::kServer, "another")) << "it would take the place of the server's unasked";
}

TEST_F(AuthorityTest, KeysAreOfTheirUserAlone) {
  for (const char* key : {"ca.key", "permissions-ca.key", "server/identity.key"}) {
    struct stat status {};
    ASSERT_EQ(::stat((place_ / key).c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600U) << key;
  }
}

TEST_F(AuthorityTest, KeyThatOthersReadIsRefused) {
  const fs::path key = place_ / "server" / identity_files::kKey;
  ASSERT_EQ(::chmod(key.c_str(), 0644), 0);
  EXPECT_THAT(ReadIdentity(place_ / "server", now_).error().what, HasSubstr("can read the key " + key.string()));
  ASSERT_EQ(::chmod(key.c_str(), 0640), 0);
  EXPECT_TRUE(ReadIdentity(place_ / "server", now_)) << "of a group that is trusted";
  fs::remove(place_ / "server" / identity_files::kPermissions);
  EXPECT_EQ(ReadIdentity(place_ / "server", now_).error().code, ErrorCode::kNotFound);
}

TEST_F(AuthorityTest, KeyOfTheAuthorityThatOthersReadIsRefused) {
  for (const char* key : {"ca.key", "permissions-ca.key"}) {
    ASSERT_EQ(::chmod((place_ / key).c_str(), 0604), 0);
    EXPECT_EQ(Authority::Open(place_).error().code, ErrorCode::kInvalidInput) << key;
    ASSERT_EQ(::chmod((place_ / key).c_str(), 0600), 0);
  }
  EXPECT_TRUE(Authority::Open(place_));
}

TEST_F(AuthorityTest, WhatEverybodyCanChangeIsRefused) {
  const fs::path server = place_ / "server";
  for (const char* file :
       {identity_files::kAuthority, identity_files::kPermissionsAuthority, identity_files::kRevoked, ""}) {
    const fs::path changed = *file == 0 ? server : server / file;
    const auto before = fs::status(changed).permissions();
    fs::permissions(changed, before | fs::perms::others_write);
    const auto read = ReadIdentity(server, now_);
    ASSERT_FALSE(read) << changed;
    EXPECT_THAT(read.error().what, HasSubstr("can change " + changed.string()));
    fs::permissions(changed, before);
  }
  EXPECT_TRUE(ReadIdentity(server, now_));
}

TEST_F(AuthorityTest, ServerHasAListOfItsOwnAuthority) {
  const fs::path list = place_ / "server" / identity_files::kRevoked;
  const auto foreign = Authority::Make(folder_.path() / "foreign", now_);
  ASSERT_TRUE(foreign);
  ASSERT_TRUE(WriteDurably(list, Text(folder_.path() / "foreign" / identity_files::kRevoked)));
  EXPECT_EQ(ReadIdentity(place_ / "server", now_).error().code, ErrorCode::kInvalidInput);
  ASSERT_TRUE(WriteDurably(list, "-----BEGIN X509 CRL-----"));
  EXPECT_EQ(ReadIdentity(place_ / "server", now_).error().code, ErrorCode::kInvalidInput);
  fs::remove(list);
  EXPECT_EQ(ReadIdentity(place_ / "server", now_).error().code, ErrorCode::kNotFound);
}

TEST_F(AuthorityTest, KeyOfAnotherIdentityIsRefused) {
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a"));
  const fs::path key = place_ / "robots/a" / identity_files::kKey;
  ASSERT_TRUE(WriteDurably(key, Text(place_ / "server/identity.key")));
  ASSERT_EQ(::chmod(key.c_str(), 0600), 0);
  EXPECT_THAT(ReadIdentity(place_ / "robots/a", now_).error().what, HasSubstr("is not the key of identity.pem"));
}

TEST_F(AuthorityTest, OperatorHasARole) {
  ASSERT_TRUE(authority_.Issue(IdentityHolder::kOperator, "ben", now_, {now_.ns + kDay_ns}, false, Role::kTechnician));
  const auto ben = ReadIdentity(place_ / "operators/ben", now_).value();
  EXPECT_EQ(ben.role, Role::kTechnician);
  EXPECT_EQ(TextOf(ben), "operator ben (technician)");
  ASSERT_TRUE(New(IdentityHolder::kOperator, "ada"));
  EXPECT_EQ(ReadIdentity(place_ / "operators/ada", now_).value().role, Role::kApprover);
}

TEST_F(AuthorityTest, FingerprintTellsThatAFileWasReplaced) {
  const std::string before = FingerprintOf(place_ / "server");
  EXPECT_EQ(FingerprintOf(place_ / "server"), before);
  ASSERT_TRUE(New(IdentityHolder::kRobot, "a"));
  EXPECT_EQ(FingerprintOf(place_ / "server"), before) << "it is told of its own folder alone";
  ASSERT_TRUE(authority_.Revoke(IdentityHolder::kRobot, "a", now_));
  EXPECT_NE(FingerprintOf(place_ / "server"), before);
}

TEST_F(AuthorityTest, FingerprintTellsThatOthersMayReadOrChangeIt) {
  const std::string before = FingerprintOf(place_ / "server");
  fs::permissions(place_ / "server" / identity_files::kKey, fs::perms::others_read, fs::perm_options::add);
  const std::string open_key = FingerprintOf(place_ / "server");
  EXPECT_NE(open_key, before);
  fs::permissions(place_ / "server", fs::perms::others_write, fs::perm_options::add);
  EXPECT_NE(FingerprintOf(place_ / "server"), open_key);
}

TEST(Permissions, EachHasItsOwnPartitions) {
  const std::string robot = PermissionsText({IdentityHolder::kRobot, "mapper-01", {}, {}, ""});
  EXPECT_THAT(robot, HasSubstr("<subject_name>CN=mapper-01,OU=robot</subject_name>"));
  EXPECT_THAT(robot, Not(HasSubstr("robot/*")));
  EXPECT_THAT(robot, Not(HasSubstr("operator/")));
  EXPECT_THAT(robot, HasSubstr("<default>DENY</default>"));
  const std::string ada = PermissionsText({IdentityHolder::kOperator, "ada", {}, {}, ""});
  EXPECT_THAT(ada, HasSubstr("<subject_name>CN=ada,O=approver,OU=operator</subject_name>"));
  EXPECT_THAT(ada, HasSubstr("<topic>rigcal/Request</topic></topics><partitions><partition>operator/approver/ada<"));
  EXPECT_THAT(ada, Not(HasSubstr("operator/*")));
  EXPECT_THAT(ada, Not(HasSubstr("CalibrationInUse"))) << "what a robot runs it tells itself";
}

TEST(Permissions, ViewerPushesNothing) {
  const auto text_of = [](Role role) { return PermissionsText({IdentityHolder::kOperator, "x", {}, {}, "", role}); };
  EXPECT_THAT(text_of(Role::kTechnician), HasSubstr("<topic>rigcal/Manifest</topic>"));
  EXPECT_THAT(text_of(Role::kViewer), Not(HasSubstr("<topic>rigcal/Manifest</topic>")));
}

TEST(Permissions, ServersAloneWriteWhatServersSay) {
  for (const IdentityHolder holder : {IdentityHolder::kRobot, IdentityHolder::kOperator}) {
    const std::string text = PermissionsText({holder, "x", {}, {}, ""});
    for (std::size_t at = text.find("<publish>"); at != std::string::npos; at = text.find("<publish>", at + 1)) {
      const std::string grant = text.substr(at, text.find("</publish>", at) - at);
      for (const char* topic : {"Receipt", "Event", "Calibration<", "RobotStatus", "Reply"})
        EXPECT_THAT(grant, Not(HasSubstr(topic))) << NameOf(holder);
    }
  }
}

}  // namespace
}  // namespace rigcal::client
