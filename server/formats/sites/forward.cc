#include "server/formats/sites/forward.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/formats/edges/edge_fields.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr const char* kSliceCure = "Send the batch again with a rigcald of this server's version.";
constexpr std::string_view kSupersededBy = "superseded_by=";
constexpr const char* kReceiptCure = "Look whether --centre names a rigcald, and of which version it is.";

}  // namespace

std::string WriteEdgeSlice(const EdgeSlice& slice) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", slice.robot.str());
    out.Integer("count", slice.count);
    out.List("items", [&] {
      for (const auto& [idx, edge] : slice.items)
        out.Object([&, &idx = idx, &edge = edge] {
          out.Integer("idx", idx);
          out.Object("edge", [&] {
            WriteEdgeSummary(out, edge);
            WriteEdgeDetail(out, edge);
            WriteBlocks(out, edge.uncertainty.blocks);
          });
        });
    });
  });
}

Result<EdgeSlice> ReadEdgeSlice(std::string_view text) {
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, {"edges of a batch", kSliceCure, kEdgeSliceBytesMax}));
  const JsonField root = document.Root();
  EdgeSlice slice;
  slice.robot = ReadId<RobotId>(root.At("robot"));
  slice.count = root.At("count").Integer(1, static_cast<std::int64_t>(limits::kEdgesPerBatchMax));
  for (const JsonField& item : root.At("items").Items(limits::kEdgesPerBatchMax)) {
    const JsonField field = item.At("edge");
    Edge edge = ReadEdgeFields(field);
    edge.uncertainty.blocks = ReadBlocks(field.At("blocks"));
    slice.items.emplace_back(item.At("idx").Integer(0, slice.count - 1), std::move(edge));
  }
  RIGCAL_TRY(document.status());
  for (const auto& [idx, edge] : slice.items) RIGCAL_TRY(Validate(edge));
  return slice;
}

std::string WriteForwardReceipt(const ForwardReceipt& receipt) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("state", receipt.is_whole ? "closed" : "receiving");
    WriteIds(out, "missing", receipt.missing);
  });
}

Result<ForwardReceipt> ReadForwardReceipt(std::string_view text) {
  constexpr std::size_t kReceiptBytesMax = 16u << 20;
  RIGCAL_ASSIGN(JsonDocument document,
                JsonDocument::Parse(text, {"the centre's answer", kReceiptCure, kReceiptBytesMax}));
  const JsonField root = document.Root();
  ForwardReceipt receipt;
  receipt.is_whole = root.At("state").Text() == "closed";
  for (const JsonField& digest : root.At("missing").Items(limits::kPayloadsPerSessionMax))
    receipt.missing.push_back(ReadId<Digest>(digest));
  RIGCAL_TRY(document.status());
  return receipt;
}

std::string WriteSupersededBy(const std::vector<SessionId>& by) {
  std::string text;
  for (const SessionId& one : by) text += (text.empty() ? "?" + std::string(kSupersededBy) : ",") + one.str();
  return text;
}

Result<std::vector<SessionId>> ReadSupersededBy(std::string_view query) {
  std::vector<SessionId> by;
  if (!query.starts_with(kSupersededBy)) return by;
  for (std::size_t at = kSupersededBy.size(); at < query.size();) {
    const std::size_t end = std::min(query.find(',', at), query.size());
    RIGCAL_ASSIGN(SessionId one, SessionId::Parse(std::string(query.substr(at, end - at))));
    by.push_back(std::move(one));
    at = end + 1;
  }
  return by;
}

std::string WriteRobotsAsked(const std::vector<RobotId>& robots) {
  return WriteObject([&](JsonWriter& out) { WriteIds(out, "robots", robots); });
}

Result<std::vector<RobotId>> ReadRobotsAsked(std::string_view text) {
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, {"robots", kSliceCure, kRobotsAskedBytesMax}));
  std::vector<RobotId> robots;
  for (const JsonField& robot : document.Root().At("robots").Items(kRobotsAskedMax))
    robots.push_back(ReadId<RobotId>(robot));
  RIGCAL_TRY(document.status());
  return robots;
}

namespace {

void WriteSaid(JsonWriter& out, const std::string& name, const std::vector<WordAtCentre>& words) {
  out.List(name, [&] {
    for (const WordAtCentre& one : words)
      out.Object([&] {
        out.Text("robot", one.robot.str());
        out.Text("digest", one.digest.str());
        out.Text("how", one.how);
        WriteStamp(out, "at", one.at);
        out.Text("who", one.who);
        out.Text("reason", one.reason);
      });
  });
}

std::vector<WordAtCentre> ReadSaid(const JsonField& field) {
  std::vector<WordAtCentre> words;
  for (const JsonField& one : field.Items(kRobotsAskedMax)) {
    words.push_back({ReadId<RobotId>(one.At("robot")), ReadId<Digest>(one.At("digest")), ReadStamp(one.At("at")),
                     one.At("who").Text(), one.At("reason").Text()});
    if (const auto how = one.Find("how")) words.back().how = how->Text();
  }
  return words;
}

}  // namespace

std::string WriteWordsAtCentre(const WordsAtCentre& words) {
  return WriteObject([&](JsonWriter& out) {
    WriteSaid(out, "in_use", words.in_use);
    WriteSaid(out, "rejected", words.rejected);
  });
}

Result<WordsAtCentre> ReadWordsAtCentre(std::string_view text) {
  constexpr std::size_t kWordsBytesMax = 64u << 20;
  RIGCAL_ASSIGN(JsonDocument document,
                JsonDocument::Parse(text, {"the centre's answer", kReceiptCure, kWordsBytesMax}));
  const JsonField root = document.Root();
  WordsAtCentre words{ReadSaid(root.At("in_use"))};
  if (const auto rejected = root.Find("rejected")) words.rejected = ReadSaid(*rejected);
  RIGCAL_TRY(document.status());
  return words;
}

std::string WriteForwardState(const std::optional<ForwardState>& state) {
  const ForwardState told = state.value_or(ForwardState{});
  return WriteObject([&](JsonWriter& out) {
    told.url.empty() ? out.Null("url") : out.Text("url", told.url);
    out.Integer("sessions_waiting", told.sessions_waiting);
    out.Integer("batches_waiting", told.batches_waiting);
    out.Integer("refused", told.refused);
    WriteStamp(out, "oldest_at", told.oldest_at);
    WriteStamp(out, "failing_since", told.failing_since);
    told.last_error.empty() ? out.Null("last_error") : out.Text("last_error", told.last_error);
  });
}

Error ReadErrorDocument(std::string_view text) {
  constexpr std::size_t kErrorBytesMax = 64u << 10;
  Error none{ErrorCode::kUnreachable, "it answered what no rigcald does", kReceiptCure};
  auto document = JsonDocument::Parse(text, {"the centre's answer", kReceiptCure, kErrorBytesMax});
  if (!document) return none;
  const JsonField error = document->Root().At("error");
  Error read{ErrorCodeOf(error.At("code").Text()), error.At("what").Text(), error.At("cure").Text()};
  return document->status() ? read : none;
}

}  // namespace rigcal::formats
