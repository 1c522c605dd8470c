// Approve, reject, roll back; and how it is told which revision is in use. Against a server in memory.
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kInUse =
    R"("in_use":{"revision":3,"how":"approved","at":"2026-11-03T12:00:00Z","who":"policy","reason":"the verdict is pass"})";

TEST(DecideVerbs, AskAsOrdersAndSayWhatIsInUse) {
  std::string asked, answer;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return answer;
  });
  answer =
      R"({"robot":"r","revision":4,"state":"approved","decision":{"revision":4,"how":"approved","who":"Ada","reason":"checked"},)"
      R"("in_use":{"revision":4,"how":"approved","who":"Ada","reason":"checked"}})";
  Ran ran = Rigcal({"approve", "r", "4", "--reason", "checked", "--by", "Ada"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, R"(approve {"robot":"r","who":"Ada","reason":"checked","revision":4})");
  EXPECT_EQ(ran.out, "Revision 4 of r was approved by Ada: checked. It is in use now.\n");
  answer =
      std::string(
          R"({"robot":"r","revision":4,"state":"rejected","decision":{"revision":4,"how":"rejected","who":"Ada","reason":"bent"},)") +
      kInUse + "}";
  ran = Rigcal({"reject", "r", "--reason", "bent", "--by", "Ada"});
  EXPECT_EQ(asked, R"(reject {"robot":"r","who":"Ada","reason":"bent"})");
  EXPECT_EQ(ran.out, "Revision 4 of r was rejected by Ada: bent. Revision 3 is in use.\n");
  answer =
      R"({"robot":"r","revision":3,"decision":{"revision":3,"how":"rolled_back","who":"Ada","reason":"bent"},"in_use":{"revision":3}})";
  ran = Rigcal({"rollback", "r", "3", "--reason", "bent", "--by", "Ada"});
  EXPECT_EQ(asked, R"(rollback {"robot":"r","who":"Ada","reason":"bent","revision":3})");
  EXPECT_EQ(ran.out, "Robot r was rolled back to revision 3 by Ada: bent. It is in use now.\n");
  const Ran none = Rigcal({"approve", "r", "0", "--reason", "x"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("0 is out of range: give a number above 0"), std::string::npos) << none.err;
  EXPECT_LT(none.err.size(), 200U) << none.err;
  const Ran nobody = Rigcal({"approve", "r", "4", "--reason", "x", "--by", ""});
  EXPECT_EQ(nobody.code, 2);
  EXPECT_NE(nobody.err.find("needs a name: say who you are, or leave the option out"), std::string::npos) << nobody.err;
  EXPECT_EQ(Rigcal({"approve", "r"}).code, 2);
  EXPECT_EQ(Rigcal({"rollback", "r", "--reason", "x"}).code, 2);
}

TEST(DecideVerbs, ShowAndStatusTellWhatIsInUse) {
  FakeServer server("r", [&](const std::string& verb, const std::string&) -> Result<std::string> {
    if (verb == "status")
      return R"({"robots":[{"robot":"r","revision":4,"state":"candidate","usable":{"revision":3},"verdict":{"level":"pass","why":"all agree"}}]})";
    return std::string(R"({"robot":"r","revision":4,"state":"candidate","decision":null,)") + kInUse +
           R"(,"document":{"robot":"r","verdict":{"level":"pass","why":"all agree"}}})";
  });
  const std::string shown = Rigcal({"show", "r"}).out;
  EXPECT_NE(shown.find("In use: revision 3 (approved by policy, 3 Nov 2026); this one is a candidate: `rigcal approve "
                       "r 4 --reason TEXT`\n"),
            std::string::npos)
      << shown;
  EXPECT_NE(shown.find("verdict  pass: all agree. `rigcal approve r 4 --reason TEXT`, if it is right.\n"),
            std::string::npos)
      << shown;
  const std::string status = Rigcal({"status", "r"}).out;
  EXPECT_NE(status.find("A candidate: revision 3 is in use."), std::string::npos) << status;
}

TEST(DecideVerbs, OfAServerOfBeforeNothingIsSaid) {
  FakeServer server("r", Always(R"({"robot":"r","revision":4,"document":{"verdict":{"level":"pass"}}})"));
  EXPECT_EQ(Rigcal({"show", "r"}).out.find("In use"), std::string::npos);
  EXPECT_EQ(Rigcal({"show", "r"}).out.find("in use"), std::string::npos);
}

TEST(DecideVerbs, LookupAsksForAnotherRevisionByItsNumber) {
  std::string asked;
  FakeServer server("r", [&](const std::string&, const std::string& json) -> Result<std::string> {
    asked = json;
    return "{}";
  });
  (void)Rigcal({"lookup", "r", "a", "b", "--revision", "4"});
  EXPECT_EQ(asked, R"({"robot":"r","a":"a","b":"b","revision":4})");
}

}  // namespace
}  // namespace rigcal::client
