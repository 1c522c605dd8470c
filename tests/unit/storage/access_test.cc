// Who may log in, which programs have tokens, who is logged in: what of it ends when, and what the audit says.
#include <gmock/gmock.h>

#include "storage/access/access_tokens.h"
#include "storage/access/accounts.h"
#include "storage/access/login_sessions.h"
#include "storage/audit.h"
#include "tests/unit/storage/engines.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Stamp kMorning{1'793'707'200'000'000'000};
constexpr std::int64_t kHour_ns = 3600LL * 1'000'000'000;

class AccessTest : public StoreTest {
 protected:
  static Word By(const std::string& who) { return {kMorning, who, ""}; }
  Account Add(const std::string& name, Role role) {
    return AddAccount(store_, {0, name, role, "hash of " + name, By("root")}).value();
  }
  std::vector<std::string> Audit() {
    std::vector<std::string> texts;
    const auto rows = LoadAudit(store_, RobotId());
    for (const AuditRow& row : *rows) texts.push_back(row.who + ": " + row.what);
    return texts;
  }
  std::int64_t Count(const std::string& table) { return IntIn(store_, "SELECT count(*) FROM " + table); }
  bool IsIn(const Digest& digest, std::int64_t after_ns) {
    return SeeLogin(store_, digest, {kMorning.ns + after_ns}).value().has_value();
  }

  const Digest one_ = DigestOf("one"), two_ = DigestOf("two");
};

TEST_F(AccessTest, AccountIsWhatItWasMadeAndChangedTo) {
  EXPECT_FALSE(HasAccounts(store_).value());
  Add("bob", Role::kViewer);
  Add("ada", Role::kAdmin);
  EXPECT_TRUE(HasAccounts(store_).value());
  const auto accounts = LoadAccounts(store_).value();
  ASSERT_EQ(accounts.size(), 2U);
  EXPECT_EQ(accounts[0].name, "ada");
  EXPECT_EQ(accounts[1].role, Role::kViewer);
  EXPECT_EQ(accounts[1].password_hash, "hash of bob");
  ASSERT_TRUE(ChangeAccount(store_, "bob", {Role::kApprover, {}}, By("ada")));
  ASSERT_TRUE(ChangeAccount(store_, "bob", {{}, "other"}, By("ada")));
  const auto bob = LoadAccount(store_, "bob").value().value();
  EXPECT_EQ(bob.role, Role::kApprover);
  EXPECT_EQ(bob.password_hash, "other");
  EXPECT_THAT(Audit(), ElementsAre("ada: gave user bob another password", "ada: made user bob approver, before viewer",
                                   "root: added user ada as admin", "root: added user bob as viewer"));
  EXPECT_FALSE(VerifyAudit(store_)->fault);
}

TEST_F(AccessTest, NothingStaysOfARemovedPassword) {
  Add("bob", Role::kViewer);
  ASSERT_TRUE(RemoveAccount(store_, "bob", By("root")));
  EXPECT_FALSE(HasAccounts(store_).value());
  EXPECT_FALSE(LoadAccount(store_, "bob").value());
  EXPECT_EQ(Count("login_password"), 0);
  EXPECT_EQ(Count("account"), 2);
  EXPECT_EQ(RemoveAccount(store_, "bob", By("root")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ChangeAccount(store_, "bob", {Role::kAdmin, {}}, By("root")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Add("bob", Role::kTechnician).role, Role::kTechnician);
}

TEST_F(AccessTest, NamesAreNamesAndOnce) {
  Add("bob", Role::kViewer);
  const auto again = AddAccount(store_, {0, "bob", Role::kAdmin, "x", By("root")});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kConflict);
  EXPECT_EQ(LoadAccount(store_, "bob").value()->role, Role::kViewer);
  for (const std::string name : {"", "a b", "<script>", "a/b", ".a", "policy", "rigcald"})
    EXPECT_EQ(AddAccount(store_, {0, name, Role::kAdmin, "x", By("root")}).error().code, ErrorCode::kInvalidInput)
        << name;
}

TEST_F(AccessTest, NobodyIsAUserAndATokenByOneName) {
  Add("ada", Role::kAdmin);
  const AccessToken of_ada{0, "ada", Role::kViewer, one_, By("root")},
      of_grafana{0, "grafana", Role::kViewer, two_, By("root")};
  EXPECT_EQ(AddAccessToken(store_, of_ada).error().code, ErrorCode::kConflict);
  EXPECT_FALSE(LoadAccessToken(store_, one_).value());
  ASSERT_TRUE(AddAccessToken(store_, of_grafana));
  EXPECT_EQ(AddAccount(store_, {0, "grafana", Role::kAdmin, "x", By("root")}).error().code, ErrorCode::kConflict);
  ASSERT_TRUE(RemoveAccount(store_, "ada", By("root")));
  EXPECT_TRUE(AddAccessToken(store_, of_ada));
  ASSERT_TRUE(RevokeAccessToken(store_, "grafana", By("root")));
  EXPECT_EQ(Add("grafana", Role::kViewer).name, "grafana");
}

TEST_F(AccessTest, LoginLastsTwelveHoursAfterItWasSeen) {
  ASSERT_TRUE(BeginLogin(store_, one_, Add("ada", Role::kApprover), kMorning));
  const auto seen = SeeLogin(store_, one_, kMorning).value();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->name, "ada");
  EXPECT_EQ(seen->role, Role::kApprover);
  EXPECT_FALSE(IsIn(two_, 0));
  EXPECT_TRUE(IsIn(one_, 12 * kHour_ns));
  EXPECT_TRUE(IsIn(one_, 24 * kHour_ns));
  EXPECT_FALSE(IsIn(one_, 36 * kHour_ns + 1));
  EXPECT_TRUE(IsIn(one_, 30 * kHour_ns)) << "to have asked too late makes nothing younger";
}

TEST_F(AccessTest, LoginEndsAfterThirtyDaysHoweverItIsUsed) {
  ASSERT_TRUE(BeginLogin(store_, one_, Add("ada", Role::kApprover), kMorning));
  for (std::int64_t hours = 11; hours <= 720; hours += 11) EXPECT_TRUE(IsIn(one_, hours * kHour_ns)) << hours;
  EXPECT_FALSE(IsIn(one_, 720 * kHour_ns + 1));
}

TEST_F(AccessTest, LogoutPasswordRoleAndRemovalEndIt) {
  const auto login = [&](const Digest& digest) {
    ASSERT_TRUE(BeginLogin(store_, digest, LoadAccount(store_, "ada").value().value(), kMorning));
    ASSERT_TRUE(IsIn(digest, 1));
  };
  Add("ada", Role::kApprover);
  login(one_), login(two_);
  ASSERT_TRUE(EndLogin(store_, one_));
  EXPECT_FALSE(IsIn(one_, 1));
  EXPECT_TRUE(IsIn(two_, 1));
  ASSERT_TRUE(ChangeAccount(store_, "ada", {{}, "other"}, By("root")));
  EXPECT_FALSE(IsIn(two_, 1));
  login(one_);
  ASSERT_TRUE(ChangeAccount(store_, "ada", {Role::kViewer, {}}, By("root")));
  EXPECT_FALSE(IsIn(one_, 1));
  login(one_);
  ASSERT_TRUE(RemoveAccount(store_, "ada", By("root")));
  EXPECT_FALSE(IsIn(one_, 1));
  EXPECT_EQ(Count("login_session"), 0);
}

TEST_F(AccessTest, LoginOfAnAccountThatChangedMeanwhileIsRefused) {
  const Account ada = Add("ada", Role::kAdmin);
  ASSERT_TRUE(ChangeAccount(store_, "ada", {Role::kViewer, {}}, By("root")));
  EXPECT_EQ(BeginLogin(store_, one_, ada, kMorning).error().code, ErrorCode::kConflict);
  EXPECT_FALSE(IsIn(one_, 0));
}

TEST_F(AccessTest, LoginsDoNotPileUp) {
  const Account ada = Add("ada", Role::kViewer);
  for (int i = 0; i < kLoginsOfAccountMax + 3; ++i)
    ASSERT_TRUE(BeginLogin(store_, DigestOf(std::to_string(i)), ada, {kMorning.ns + i}));
  EXPECT_EQ(Count("login_session"), kLoginsOfAccountMax);
  EXPECT_FALSE(IsIn(DigestOf("2"), 100));
  EXPECT_TRUE(IsIn(DigestOf("3"), 100));
  ASSERT_TRUE(BeginLogin(store_, one_, ada, {kMorning.ns + 13 * kHour_ns}));
  EXPECT_EQ(Count("login_session"), 1);
}

TEST_F(AccessTest, TokenIsGoodUntilItIsRevoked) {
  ASSERT_TRUE(AddAccessToken(store_, {0, "grafana", Role::kViewer, one_, By("root")}));
  EXPECT_EQ(LoadAccessToken(store_, one_).value()->name, "grafana");
  EXPECT_FALSE(LoadAccessToken(store_, two_).value());
  EXPECT_EQ(AddAccessToken(store_, {0, "grafana", Role::kAdmin, two_, By("root")}).error().code, ErrorCode::kConflict);
  ASSERT_TRUE(RevokeAccessToken(store_, "grafana", By("ada")));
  EXPECT_FALSE(LoadAccessToken(store_, one_).value());
  EXPECT_TRUE(LoadAccessTokens(store_).value().empty());
  EXPECT_EQ(RevokeAccessToken(store_, "grafana", By("ada")).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(AddAccessToken(store_, {0, "grafana", Role::kAdmin, two_, By("root")}));
  EXPECT_EQ(LoadAccessTokens(store_).value().front().role, Role::kAdmin);
  EXPECT_THAT(Audit(), ElementsAre("root: made a token for grafana as admin", "ada: revoked the token of grafana",
                                   "root: made a token for grafana as viewer"));
}

}  // namespace
}  // namespace rigcal::storage
