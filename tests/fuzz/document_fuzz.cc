#include <sstream>

#include "client/text/document.h"
#include "client/text/edge_table.h"
#include "client/text/pose_text.h"
#include "client/wire/reply_parts.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

// What the verbs print of any document, of the right shape or not.
std::string Printed(const client::Document& document) {
  std::ostringstream out;
  client::PrintEdges(document["edges"].Items(), out);
  client::PrintDiagnoses(document["diagnoses"], out);
  client::PrintGlobalError(document, out);
  client::PrintMatrix(document["covariance"], "  ", out);
  out << client::EdgeLine(document) << client::Triple(document["p_m"], client::kMmPerM, 3)
      << client::RpyText(document, 3);
  return out.str();
}

std::string WithoutLineBreaks(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

// A reply in parts of the size that the first byte says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t part_bytes = 1 + input.Number<std::uint8_t>();
  const std::string text(input.rest().substr(0, input.rest().find('\0')));
  const auto part_count = static_cast<std::uint32_t>(text.size() / part_bytes + 1);
  client::ReplyParts parts;
  std::optional<std::string> whole;
  for (std::uint32_t part = 0; part < part_count; ++part)
    whole = parts.Add(part, part_count, text.substr(part * part_bytes, part_bytes).c_str());
  fuzz::Require(whole && *whole == text, "a reply is the sum of its parts");
  const auto document = client::Document::Parse(*whole, "the reply");
  if (!fuzz::RequireGoodError(document)) return 0;
  const std::string printed = WithoutLineBreaks(Printed(*document));
  fuzz::Require(IsPrintableUtf8(printed), "what is shown is printable", Quoted(printed));
  const auto again = client::Document::Parse(document->Dump(), "itself");
  fuzz::Require(again && again->Dump() == document->Dump(), "a document is written and read again");
  return 0;
}
