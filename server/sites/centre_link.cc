#include "server/sites/centre_link.h"

#include <arpa/inet.h>
#include <curl/curl.h>

#include <algorithm>
#include <memory>

#include "server/base/text.h"

namespace rigcal::sites {
namespace {

constexpr const char* kForwardPath = "/api/v1/forward";
constexpr std::size_t kUrlBytesMax = 2048;

struct UrlParts {
  std::string scheme, host, user, path;
};

std::string PartOf(CURLU* url, CURLUPart part) {
  char* text = nullptr;
  if (curl_url_get(url, part, &text, 0) != CURLUE_OK) return "";
  const std::unique_ptr<char, decltype(&curl_free)> owned(text, &curl_free);
  return text;
}

UrlParts PartsOf(const std::string& url) {
  const std::unique_ptr<CURLU, decltype(&curl_url_cleanup)> parsed(curl_url(), &curl_url_cleanup);
  if (!parsed || curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK) return {};
  return {PartOf(parsed.get(), CURLUPART_SCHEME), PartOf(parsed.get(), CURLUPART_HOST),
          PartOf(parsed.get(), CURLUPART_USER),
          PartOf(parsed.get(), CURLUPART_PATH) + PartOf(parsed.get(), CURLUPART_QUERY)};
}

bool IsThisMachine(const std::string& host) {
  in_addr address{};
  const bool is_number = inet_pton(AF_INET, host.c_str(), &address) == 1;  // 127.0.0.1.example.org is none
  return host == "localhost" || (is_number && host.starts_with("127.")) || host == "[::1]";
}

// It is about what was sent; all else is about the way there: the token, the room on its disk, another program.
bool IsOfContent(int status) { return status == 400 || status == 404 || status == 409 || status == 413; }

Status StatusOf(const Transfer& transfer) {
  if (transfer.status == 200) return {};
  Error error = formats::ReadErrorDocument(transfer.reply);
  const bool is_of_content = IsOfContent(transfer.status) && error.code != ErrorCode::kUnreachable;
  const bool is_busy = transfer.status == 503 && error.code == ErrorCode::kBusy;
  if (!is_of_content && !is_busy) error.code = ErrorCode::kUnreachable;
  error.what = (is_of_content ? "the centre refuses it: " : "the centre does not take anything: ") + error.what;
  return Fail(std::move(error));
}

}  // namespace

Status CheckCentre(const CentreAddress& centre) {
  const UrlParts parts = PartsOf(centre.url);
  const bool is_whole = !parts.host.empty() && parts.user.empty() && (parts.path.empty() || parts.path == "/") &&
                        centre.url.size() <= kUrlBytesMax && IsPrintableUtf8(centre.url);
  const bool is_scheme = parts.scheme == "https" || parts.scheme == "http";
  if (!is_whole || !is_scheme)
    return Fail(ErrorCode::kInvalidInput, "--centre " + Quoted(centre.url) + " is no address of a rigcald",
                "Write, for instance, https://rigs.example.org.");
  if (parts.scheme == "http" && !IsThisMachine(parts.host))
    return Fail(ErrorCode::kInvalidInput, "--centre " + centre.url + " would send pictures and the token unprotected",
                "Write https://; http:// is for a centre on this machine alone.");
  if (centre.token.empty())
    return Fail(ErrorCode::kInvalidInput, "the token for --centre " + centre.url + " is empty",
                "Make one at the centre, `rigcal token new NAME --role site`, and give its file with "
                "--centre-token-file.");
  return {};
}

Status CentreLink::Ask(std::vector<Transfer>& transfers) const {
  const std::size_t at_once = at_once_;
  at_once_ = std::max<std::size_t>(1, at_once / 2);
  RIGCAL_TRY(CarryOut(centre_, transfers, at_once, went_on_));
  for (const Transfer& transfer : transfers)
    if (transfer.status != 0) RIGCAL_TRY(StatusOf(transfer));  // 0: it was not begun, as one before was refused
  at_once_ = std::min(kAtOnce, at_once + 1);
  return {};
}

Status CentreLink::Greet() const {
  std::vector<Transfer> asked = {{"GET", kForwardPath}};
  return Ask(asked);
}

Result<formats::ForwardReceipt> CentreLink::SendManifest(const SessionId& session, std::string text,
                                                         const std::vector<SessionId>& superseded_by) const {
  std::vector<Transfer> asked = {
      {"POST", std::string(kForwardPath) + "/sessions/" + session.str() + formats::WriteSupersededBy(superseded_by),
       std::move(text)}};
  RIGCAL_TRY(Ask(asked));
  return formats::ReadForwardReceipt(asked.front().reply);
}

Status CentreLink::SendBlobs(const SessionId& session, const std::vector<BlobFile>& blobs) const {
  std::vector<Transfer> asked;
  for (const BlobFile& blob : blobs)
    asked.push_back({"PUT", std::string(kForwardPath) + "/sessions/" + session.str() + "/blobs/" + blob.digest.str(),
                     "", blob.file, blob.size_bytes});
  return Ask(asked);
}

Result<formats::ForwardReceipt> CentreLink::SendEdges(const BatchId& batch, const formats::EdgeSlice& slice) const {
  std::vector<Transfer> asked = {
      {"POST", std::string(kForwardPath) + "/batches/" + batch.str(), formats::WriteEdgeSlice(slice)}};
  RIGCAL_TRY(Ask(asked));
  return formats::ReadForwardReceipt(asked.front().reply);
}

Result<bool> CentreLink::Has(const std::string& subject) const {
  std::vector<Transfer> asked = {{"GET", kForwardPath + subject}};
  const Status answered = Ask(asked);
  if (!answered && IsOfTheWay(answered.error().code)) return Fail(answered.error());
  return answered || answered.error().code != ErrorCode::kNotFound;
}

Result<bool> CentreLink::HasSession(const SessionId& session) const { return Has("/sessions/" + session.str()); }

Result<bool> CentreLink::HasBatch(const BatchId& batch) const { return Has("/batches/" + batch.str()); }

Result<formats::WordsAtCentre> CentreLink::AskInUse(const std::vector<RobotId>& robots) const {
  std::vector<Transfer> asked = {{"POST", std::string(kForwardPath) + "/in_use", formats::WriteRobotsAsked(robots)}};
  RIGCAL_TRY(Ask(asked));
  return formats::ReadWordsAtCentre(asked.front().reply);
}

}  // namespace rigcal::sites
