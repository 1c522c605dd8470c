// `rigcal report` against a server in memory: a report that the server has pruned is asked for, and said to be missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/text/document.h"
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

using testing::HasSubstr;
using testing::Not;

// One with a report of revision 1, unless `missing` says why not.
FakeServer::AnswerTo ServerOfReports(const std::optional<Error>& missing, int& asked) {
  return [&missing, &asked](const std::string& verb, const std::string& json) -> Result<std::string> {
    if (verb == "revisions") return R"({"revisions":[{"revision":2},{"revision":1}]})";
    if (verb == "status") return R"({"http_address":"http://127.0.0.1:8420","robots":[{"robot":"r","revision":2}]})";
    EXPECT_EQ(verb, "report_files");
    EXPECT_EQ(json, R"({"robot":"r","revision":1})");
    ++asked;
    if (missing) return Fail(*missing);
    return R"({"robot":"r","revision":1,"files":[{"path":"index.html","bytes":7}]})";
  };
}

TEST(Report, OneThatWasPrunedIsAskedForAndSaidToCome) {
  std::optional<Error> missing =
      Error{ErrorCode::kBusy, "the report of revision 1 of r is being drawn again, as its folder was gone",
            "Ask for it again in a few seconds."};
  int asked = 0;
  FakeServer server("r", ServerOfReports(missing, asked));
  const Ran coming = Rigcal({"report", "r", "--revision", "1"});
  EXPECT_EQ(coming.code, 0) << coming.err;
  EXPECT_GE(asked, 1);
  EXPECT_THAT(coming.out, HasSubstr("address  http://127.0.0.1:8420/robots/r/revisions/1/\n"));
  EXPECT_THAT(coming.out, HasSubstr("It is not there yet: the report of revision 1 of r is being drawn again, as its "
                                    "folder was gone. Ask for it again in a few seconds.\n"));
  EXPECT_THAT(Rigcal({"report", "r", "--revision", "1", "--json"}).out, HasSubstr("\"is_there\":false"));
  missing.reset();
  const Ran there = Rigcal({"report", "r", "--revision", "1"});
  EXPECT_EQ(there.code, 0) << there.err;
  EXPECT_THAT(there.out,
              HasSubstr("file     reports/r/1/index.html  (in the server's data folder; opens from disk)\n"));
  EXPECT_THAT(there.out, Not(HasSubstr("not there")));
  EXPECT_THAT(Rigcal({"report", "r", "--revision", "1", "--json"}).out, HasSubstr("\"is_there\":true"));
}

TEST(Report, OneThatCannotBeDrawnSaysWhy) {
  const std::optional<Error> missing = Error{
      ErrorCode::kNotFound, "the report of revision 1 of r could not be drawn: the disk is full", "Free some space."};
  int asked = 0;
  FakeServer server("r", ServerOfReports(missing, asked));
  const Ran ran = Rigcal({"report", "r", "--revision", "1"});
  EXPECT_EQ(ran.code, 4);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr("could not be drawn: the disk is full. Free some space."));
}

}  // namespace
}  // namespace rigcal::client
