// What people decide is in the audit, listed by pages, and whether it holds is told.
#include "storage/audit.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "storage/access/accounts.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;

class AuditAnswersTest : public PipelineTest {
 protected:
  Result<std::string> Asked(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    return Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump());
  }
  json Ask(const std::string& verb, const json& parameters) {
    const auto answer = Asked(verb, parameters);
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  void Decide() {
    StoreEdges(Triangle("r"));
    StepAll();
    const auto order = [&](const std::string& verb, const json& parameters) {
      const auto done = CarryOut(*store_, clock_, verb, parameters.dump());
      EXPECT_TRUE(done) << Sentence(done.error());
    };
    order("set_policy", {{"who", "Eve"}, {"reason", "new"}, {"text", "max_age_days: 9"}});
    order("retire", {{"sensor", "c"}, {"robot", "r"}, {"who", "Ada"}, {"reason", "off"}});
    order("restore", {{"sensor", "c"}, {"robot", "r"}, {"who", "Ada"}});
  }
};

TEST_F(AuditAnswersTest, EveryOrderIsARow) {
  Decide();
  const json all = Ask("audit", json::object());
  EXPECT_FALSE(all.contains("next"));
  const json rows = all["rows"];
  ASSERT_GE(rows.size(), 3u);
  EXPECT_EQ(rows[0]["what"], "restored sensor c of robot r");
  EXPECT_EQ(rows[1]["who"], "Ada");
  EXPECT_EQ(rows[1]["robot"], "r");
  EXPECT_TRUE(rows[2]["robot"].is_null());
  const json page = Ask("audit", {{"robot", "r"}, {"limit", 1}});
  ASSERT_EQ(page["rows"].size(), 1u);
  EXPECT_EQ(page["next"], page["rows"][0]["number"]);
  EXPECT_EQ(Ask("audit", {{"robot", "r"}, {"limit", 1}, {"before", page["next"]}})["rows"][0]["what"],
            "retired sensor c of robot r: off");
  EXPECT_EQ(Asked("audit", {{"robot", "nobody"}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Asked("audit", {{"before", 0}}).error().code, ErrorCode::kInvalidInput);
}

TEST_F(AuditAnswersTest, NamesOverDdsAreMarkedOnceThereAreUsers) {
  StoreEdges(Triangle("r"));
  StepAll();
  const std::string order = R"({"robot":"r","sensor":"c","who":"ada","reason":"off"})";
  EXPECT_EQ(WithChannel(*store_, order, {OrderChannel::kDds}).value(), order);
  ASSERT_TRUE(storage::AddAccount(*store_, {0, "ada", Role::kAdmin, "a hash", {clock_.Now(), "Eve", ""}}));
  EXPECT_EQ(WithChannel(*store_, order, {OrderChannel::kHttp}).value(), order);
  const auto done = CarryOut(*store_, clock_, "retire", WithChannel(*store_, order, {OrderChannel::kDds}).value());
  ASSERT_TRUE(done) << Sentence(done.error());
  EXPECT_EQ(Ask("audit", json::object())["rows"][0]["who"], "ada (over DDS, not verified)");
  EXPECT_EQ(WithChannel(*store_, R"({"who":" "})", {OrderChannel::kDds}).value(), R"({"who":" "})") << "nobody";
  EXPECT_FALSE(WithChannel(*store_, R"({"who":"Policy"})", {OrderChannel::kDds})) << "it would pass for the policy";
  const OrderOrigin verified{OrderChannel::kDds, VerifiedPerson{"ada", Role::kApprover}};
  const std::string of_ada = "{\"who\":\"ada (over DDS, verified)\"}";
  EXPECT_EQ(WithChannel(*store_, R"({"who":"ada"})", verified).value(), of_ada);
  EXPECT_EQ(WithChannel(*store_, "{}", verified).value(), of_ada);
  EXPECT_EQ(WithChannel(*store_, R"({"who":"eve"})", verified).error().what,
            "an order by 'eve' came with the identity of operator ada");
  EXPECT_FALSE(WithChannel(*store_, R"({"who":[[1]]})", {OrderChannel::kDds}));
  EXPECT_FALSE(storage::VerifyAudit(*store_)->fault);
}

TEST(OrderRoles, IdentityGivesTheOrdersOfItsRole) {
  const auto may = [](Role role, const std::string& verb) {
    return CheckMayGive(verb, {OrderChannel::kDds, VerifiedPerson{"ben", role}}).has_value();
  };
  EXPECT_FALSE(may(Role::kViewer, "retire"));
  EXPECT_TRUE(may(Role::kTechnician, "retire"));
  EXPECT_FALSE(may(Role::kTechnician, "approve"));
  EXPECT_TRUE(may(Role::kApprover, "approve"));
  EXPECT_FALSE(may(Role::kApprover, "set_policy"));
  EXPECT_TRUE(may(Role::kAdmin, "set_policy"));
  EXPECT_TRUE(CheckMayGive("approve", {OrderChannel::kDds})) << "without identities nobody has a role";
}

TEST_F(AuditAnswersTest, AFlippedByteIsNamed) {
  Decide();
  const json whole = Ask("audit_verify", json::object());
  EXPECT_TRUE(whole["fault"].is_null()) << whole;
  EXPECT_EQ(whole["head"]["hash"], Ask("audit", {{"limit", 1}})["rows"][0]["hash"]);
  const std::int64_t last = whole["head"]["number"];
  store_->database().exec("DROP TRIGGER audit_no_update; UPDATE audit SET who = 'Adb' WHERE number = " +
                          std::to_string(last));
  const json broken = Ask("audit_verify", json::object());
  EXPECT_EQ(broken["fault"]["number"], last);
  EXPECT_EQ(broken["rows"], whole["rows"].get<std::int64_t>() - 1);
}

}  // namespace
}  // namespace rigcal::pipeline
