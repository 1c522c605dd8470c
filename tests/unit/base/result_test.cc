#include "server/base/result.h"

#include <gtest/gtest.h>

#include "server/base/text.h"

namespace rigcal {
namespace {

Result<int> Half(int number) {
  if (number % 2 != 0) return Fail(ErrorCode::kInvalidInput, "the number is odd", "Give an even one.");
  return number / 2;
}
Result<int> Quarter(int number) {
  RIGCAL_ASSIGN(const int half, Half(number));
  RIGCAL_TRY(Half(half));
  return half / 2;
}

TEST(Result, AssignAndTryPassTheErrorOn) {
  EXPECT_EQ(Quarter(12).value(), 3);
  EXPECT_EQ(Quarter(3).error().what, "the number is odd");
  EXPECT_EQ(Quarter(6).error().cure, "Give an even one.");
}

TEST(Sentence, JoinsWhatAndCureInOneLine) {
  EXPECT_EQ(Sentence({ErrorCode::kBusy, "the queue is full", "Try again later."}),
            "the queue is full. Try again later.");
  EXPECT_EQ(Sentence({ErrorCode::kBusy, "Is it full?", "Try again\nlater"}), "Is it full? Try again later.");
  EXPECT_EQ(Sentence({ErrorCode::kBusy, "full", ""}), "full.");
  EXPECT_EQ(Sentence({ErrorCode::kBusy, "", ""}), "");
}

TEST(ErrorCode, NamesAreStableAndRoundTrip) {
  EXPECT_EQ(NameOf(ErrorCode::kInvalidInput), "invalid_input");
  for (ErrorCode code : {ErrorCode::kInvalidInput, ErrorCode::kNotFound, ErrorCode::kConflict, ErrorCode::kBusy,
                         ErrorCode::kUnreachable, ErrorCode::kUnsupported, ErrorCode::kStorage, ErrorCode::kInternal})
    EXPECT_EQ(ErrorCodeOf(NameOf(code)), code);
  EXPECT_EQ(ErrorCodeOf("of a newer version"), ErrorCode::kInternal);
}

TEST(Quoted, EscapesAndCutsWhatIsNotPrintable) {
  EXPECT_EQ(Quoted("a\"b\\c"), R"("a\"b\\c")");
  EXPECT_EQ(Quoted("\x1b[31m\xff"), R"("\x1b[31m\xff")");
  EXPECT_EQ(Quoted(std::string(81, 'a')), "\"" + std::string(80, 'a') + "...\"");
}

TEST(IsPrintableUtf8, AcceptsTextInAnyScript) {
  EXPECT_TRUE(IsPrintableUtf8(""));
  EXPECT_TRUE(IsPrintableUtf8("Jürgen 上海 \xF0\x9F\xA4\x96"));
}

TEST(IsPrintableUtf8, RefusesControlsAndBrokenSequences) {
  EXPECT_FALSE(IsPrintableUtf8("two\nlines"));
  EXPECT_FALSE(IsPrintableUtf8(std::string_view("nul\0", 4)));
  EXPECT_FALSE(IsPrintableUtf8("\x7f"));
  EXPECT_FALSE(IsPrintableUtf8("\xc2\x85"));          // a C1 control
  EXPECT_FALSE(IsPrintableUtf8("\xe2\x80\xae"));      // right-to-left override: shows another text than it is
  EXPECT_FALSE(IsPrintableUtf8("\xc0\xaf"));          // '/' in two bytes
  EXPECT_FALSE(IsPrintableUtf8("\xe0\x80\xaf"));      // '/' in three bytes
  EXPECT_FALSE(IsPrintableUtf8("\xed\xa0\x80"));      // a surrogate
  EXPECT_FALSE(IsPrintableUtf8("\xf4\x90\x80\x80"));  // beyond the last code point
  EXPECT_FALSE(IsPrintableUtf8("\xc3"));              // cut
  EXPECT_FALSE(IsPrintableUtf8("\xc3\x28"));          // no continuation
}

}  // namespace
}  // namespace rigcal
