// What is in use at the centre is approved at the site: the same document, and the newer word.
#include "server/sites/take_over.h"

#include <gmock/gmock.h>

#include "storage/revisions/decisions.h"
#include "tests/unit/http/client.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::sites {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class TakeOverTest : public storage::StoreTest {
 protected:
  void SetUp() override {
    for (const std::int64_t watermark : {1, 2})
      ASSERT_TRUE(storage::AppendRevision(store_, storage::MakeRevision(watermark)));
    http::Options options;
    options.logins.of_token = [](const std::string&) -> Result<std::optional<http::Person>> {
      return http::Person{"harbour", Role::kViewer, "*"};
    };
    options.answer_site = [this](const http::SiteRequest& request) -> Result<std::string> {
      RIGCAL_ASSIGN(asked_, request.read(static_cast<std::size_t>(request.body_bytes)));
      formats::WordsAtCentre words;
      if (!how_.empty()) words.in_use.push_back({storage::kRobot, digest_, at_, "Ada", "checked", how_});
      if (rejected_at_)
        words.rejected.push_back(
            {storage::kRobot, storage::DigestOf(second_), *rejected_at_, "Ada", "a soft floor", "rejected"});
      return formats::WriteWordsAtCentre(words);
    };
    auto server = http::Server::Start(
        options, [](const std::string&, const std::string&) -> Result<http::Page> { return http::Page{}; });
    ASSERT_TRUE(server);
    centre_.emplace(std::move(*server));
  }
  // The orders that were given.
  std::vector<std::string> TakeOverNow(const std::string& document, Stamp at) {
    digest_ = storage::DigestOf(document);
    at_ = at;
    const CentreLink link({"http://127.0.0.1:" + std::to_string(centre_->port()), "token", ""}, [] { return true; });
    std::vector<std::string> given;
    const GivesOrder give = [&](const std::string& verb, const std::string& json) -> Result<std::string> {
      given.push_back(verb + " " + json);
      if (!is_carried_out_at_) return "{}";
      const std::size_t reason = json.find("checked");
      const Word word{*is_carried_out_at_, "Ada at the centre", json.substr(reason, json.find('"', reason) - reason)};
      RIGCAL_TRY(storage::AppendDecision(store_, storage::kRobot, 1, storage::Deciding::kApprove, word));
      return "{}";
    };
    EXPECT_TRUE(TakeOver(store_, link, give, told_));
    return given;
  }
  void Decide(int revision, storage::Deciding deciding, Stamp at) {
    ASSERT_TRUE(storage::AppendDecision(store_, storage::kRobot, revision, deciding, {at, "Eve", "why"}));
  }

  const std::string first_ = storage::MakeRevision(1).document, second_ = storage::MakeRevision(2).document;
  std::string asked_, how_ = "approved";    // how: empty: nothing is in use there
  std::optional<Stamp> rejected_at_;        // the second document, there
  std::optional<Stamp> is_carried_out_at_;  // an approval of the first revision
  Digest digest_;
  Stamp at_;
  std::set<Digest> told_;
  std::optional<http::Server> centre_;
};

TEST_F(TakeOverTest, ApprovesTheSameDocumentInTheNameOfWhoDecided) {
  EXPECT_THAT(TakeOverNow(first_, {100}),
              ElementsAre(R"j(approve {"reason":"checked (said there 1970-01-01T00:00:00.0000001Z)",)j"
                          R"j("revision":1,"robot":"mapper-01","who":"Ada at the centre"})j"));
  EXPECT_EQ(asked_, R"({"robots":["mapper-01"]})");
  EXPECT_THAT(TakeOverNow(second_, {100}), ElementsAre(HasSubstr(R"("revision":2)")));
}

TEST_F(TakeOverTest, LeavesAloneWhatWasNotWorkedOutHere) {
  EXPECT_THAT(TakeOverNow("another document", {100}), IsEmpty());
  EXPECT_EQ(told_.size(), 1u) << "the log says so once";
}

TEST_F(TakeOverTest, TheNewerWordHolds) {
  Decide(2, storage::Deciding::kApprove, {200});
  EXPECT_THAT(TakeOverNow(first_, {100}), IsEmpty()) << "the one in use here was decided later";
  EXPECT_THAT(TakeOverNow(second_, {300}), IsEmpty()) << "it is in use already";
  EXPECT_THAT(TakeOverNow(first_, {300}), ElementsAre(HasSubstr(R"("revision":1)")));
  Decide(1, storage::Deciding::kReject, {400});
  Decide(2, storage::Deciding::kReject, {400});
  EXPECT_THAT(TakeOverNow(first_, {300}), IsEmpty()) << "somebody here said no after it";
  EXPECT_THAT(TakeOverNow(first_, {500}), ElementsAre(HasSubstr(R"("revision":1)")));
}

TEST_F(TakeOverTest, ARollbackIsTakenOverAsOne) {
  Decide(1, storage::Deciding::kApprove, {10});
  Decide(2, storage::Deciding::kApprove, {20});
  how_ = "rolled_back";
  EXPECT_THAT(TakeOverNow(first_, {100}), ElementsAre(HasSubstr("rollback {")));
  Decide(1, storage::Deciding::kReject, {50});
  EXPECT_THAT(TakeOverNow(first_, {100}), ElementsAre(HasSubstr("approve {")))
      << "nobody goes back to what was rejected";
}

TEST_F(TakeOverTest, ARollbackToWhatWasNeverApprovedHereApprovesIt) {
  how_ = "rolled_back";
  EXPECT_THAT(TakeOverNow(first_, {100}), ElementsAre(HasSubstr("approve {")));
}

TEST_F(TakeOverTest, ARejectionIsTakenOver) {
  how_.clear();
  rejected_at_ = Stamp{100};
  EXPECT_THAT(TakeOverNow("", {}), ElementsAre(AllOf(HasSubstr("reject {"), HasSubstr(R"("revision":2)"),
                                                     HasSubstr("a soft floor"), HasSubstr("Ada at the centre"))));
  const Word by_policy{{200}, kPolicyWho, "the verdict is pass"};
  ASSERT_TRUE(storage::AppendDecision(store_, storage::kRobot, 2, storage::Deciding::kApprove, by_policy));
  EXPECT_THAT(TakeOverNow("", {}), ElementsAre(HasSubstr("reject {"))) << "the policy is no person";
  Decide(2, storage::Deciding::kReject, {210});
  EXPECT_THAT(TakeOverNow("", {}), IsEmpty()) << "it is so already";
  Decide(2, storage::Deciding::kApprove, {220});
  EXPECT_THAT(TakeOverNow("", {}), IsEmpty()) << "somebody here said yes after it";
}

TEST_F(TakeOverTest, AWordFromAClockAheadIsTakenOverOnce) {
  is_carried_out_at_ = Stamp{100};
  EXPECT_THAT(TakeOverNow(first_, {10'000}), ElementsAre(HasSubstr(R"("revision":1)")));
  Decide(1, storage::Deciding::kReject, {200});
  EXPECT_THAT(TakeOverNow(first_, {10'000}), IsEmpty()) << "somebody here said no after that";
  EXPECT_THAT(TakeOverNow(first_, {20'000}), ElementsAre(HasSubstr(R"("revision":1)"))) << "it was said anew";
}

}  // namespace
}  // namespace rigcal::sites
