#include "server/sites/transfers.h"

#include <curl/curl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <memory>
#include <mutex>

#include "server/base/files/file_descriptor.h"
#include "server/base/version.h"

namespace rigcal::sites {
namespace {

constexpr long kConnectMax_ms = 15'000;
constexpr long kSilentMax_s = 90;  // longer than the centre takes to say that it has no room
constexpr int kLookAgain_ms = 500;
constexpr std::size_t kReplyBytesMax = 16u << 20;

struct Headers {
  curl_slist* list = nullptr;
  Headers() = default;
  Headers(const Headers&) = delete;
  Headers& operator=(const Headers&) = delete;
  ~Headers() { curl_slist_free_all(list); }
  void Add(const std::string& line) { list = curl_slist_append(list, line.c_str()); }
};

// One that is under way.
struct Active {
  explicit Active(Transfer& carried) : transfer(carried), curl(curl_easy_init(), &curl_easy_cleanup) {}
  Transfer& transfer;
  Headers headers;
  FileDescriptor file{-1};
  std::size_t body_at = 0;
  std::string why;
  std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl;  // gone before what it borrows
};

std::size_t TakeReply(char* bytes, std::size_t size, std::size_t count, void* active) {
  std::string& reply = static_cast<Active*>(active)->transfer.reply;
  if (reply.size() + size * count > kReplyBytesMax) return 0;
  reply.append(bytes, size * count);
  return size * count;
}

std::size_t GiveBytes(char* to, std::size_t size, std::size_t count, void* given) {
  Active& active = *static_cast<Active*>(given);
  if (active.file.get() >= 0) {
    const std::ptrdiff_t got = ReadSome(active.file, to, size * count);
    const bool is_short = got == 0 && active.body_at < static_cast<std::size_t>(active.transfer.file_bytes);
    if (got >= 0 && !is_short) {
      active.body_at += static_cast<std::size_t>(got);
      return static_cast<std::size_t>(got);
    }
    active.why = active.transfer.file.string() + (is_short ? ": is shorter than it was" : ": cannot be read");
    return CURL_READFUNC_ABORT;
  }
  const std::size_t got = active.transfer.body.copy(to, size * count, active.body_at);
  active.body_at += got;
  return got;
}

// Where the kernel has it: its pace does not fall with each packet that the line loses.
int PreferBbr(void*, curl_socket_t socket, curlsocktype) {
  constexpr std::string_view kBbr = "bbr";
  static_cast<void>(setsockopt(socket, IPPROTO_TCP, TCP_CONGESTION, kBbr.data(), kBbr.size()));
  return CURL_SOCKOPT_OK;
}

// The certificate is always looked at.
void TrustOnly(CURL* curl, const CentreAddress& centre) {
  const bool is_tls = centre.url.rfind("https://", 0) == 0;
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, is_tls ? "https" : "http");
  curl_easy_setopt(curl, CURLOPT_SSL_VERIFYPEER, 1L);
  curl_easy_setopt(curl, CURLOPT_SSL_VERIFYHOST, 2L);
  curl_easy_setopt(curl, CURLOPT_SSLVERSION, CURL_SSLVERSION_TLSv1_2);
  if (!centre.ca.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, centre.ca.c_str());
  if (!is_tls) curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 0L);
}

void SetBody(Active& active) {
  CURL* const curl = active.curl.get();
  const Transfer& transfer = active.transfer;
  if (transfer.method == "GET") return;
  const auto bytes = transfer.file.empty() ? static_cast<std::int64_t>(transfer.body.size()) : transfer.file_bytes;
  curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
  curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, transfer.method.c_str());
  curl_easy_setopt(curl, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(bytes));
  curl_easy_setopt(curl, CURLOPT_READFUNCTION, &GiveBytes);
  curl_easy_setopt(curl, CURLOPT_READDATA, &active);
  curl_easy_setopt(curl, CURLOPT_UPLOAD_BUFFERSIZE, 512L << 10);
}

void SetUp(Active& active, const CentreAddress& centre) {
  CURL* const curl = active.curl.get();
  active.headers.Add("Authorization: Bearer " + centre.token);
  active.headers.Add("Expect:");
  const std::string agent = "rigcald/" + std::string(Version());
  curl_easy_setopt(curl, CURLOPT_URL, (centre.url + active.transfer.path).c_str());
  TrustOnly(curl, centre);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, kConnectMax_ms);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, kSilentMax_s);
  curl_easy_setopt(curl, CURLOPT_USERAGENT, agent.c_str());
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, active.headers.list);
  curl_easy_setopt(curl, CURLOPT_SOCKOPTFUNCTION, &PreferBbr);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &TakeReply);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &active);
  curl_easy_setopt(curl, CURLOPT_PRIVATE, &active);
  SetBody(active);
}

Error Unreached(const std::string& why) {
  return {ErrorCode::kUnreachable, "no answer from the centre: " + why,
          "Look whether it runs, and whether this machine reaches it."};
}

class Round {
 public:
  Round(const CentreAddress& centre, std::vector<Transfer>& transfers, std::size_t at_once)
      : centre_(centre), transfers_(transfers), at_once_(at_once), multi_(curl_multi_init(), &curl_multi_cleanup) {}
  ~Round() {
    for (const auto& one : active_) curl_multi_remove_handle(multi_.get(), one->curl.get());
  }
  Round(const Round&) = delete;
  Round& operator=(const Round&) = delete;

  Status Run(const std::function<bool()>& went_on) {
    while (true) {
      RIGCAL_TRY(Begin());
      if (active_.empty()) return ended_;
      int running = 0;
      curl_multi_perform(multi_.get(), &running);
      End();
      if (!went_on()) return Fail(Unreached("this server ends"));
      if (running > 0) curl_multi_poll(multi_.get(), nullptr, 0, kLookAgain_ms, nullptr);
    }
  }

 private:
  Status Begin() {
    while (active_.size() < at_once_ && next_ < transfers_.size()) {
      auto one = std::make_unique<Active>(transfers_[next_]);
      if (!one->curl || !multi_) return Fail(Unreached("libcurl cannot be used"));
      if (!one->transfer.file.empty()) {
        RIGCAL_ASSIGN(one->file, OpenToRead(one->transfer.file));
      }
      SetUp(*one, centre_);
      curl_multi_add_handle(multi_.get(), one->curl.get());
      active_.push_back(std::move(one));
      ++next_;
    }
    return {};
  }

  // An answer may be there also where not all was sent: the centre need not read what it refuses.
  void End() {
    int left = 0;
    while (const CURLMsg* message = curl_multi_info_read(multi_.get(), &left)) {
      if (message->msg != CURLMSG_DONE) continue;
      Active* active = nullptr;
      curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &active);
      const CURLcode done = message->data.result;
      long status = 0;
      curl_easy_getinfo(message->easy_handle, CURLINFO_RESPONSE_CODE, &status);
      active->transfer.status = static_cast<int>(status);
      const Status ended = HowEnded(*active, done);
      const bool is_good = ended && status == 200;
      if (!ended && ended_) ended_ = ended;
      if (!is_good) next_ = transfers_.size();  // the others that began go on: what they sent is not to be lost
      Remove(*active);
    }
  }

  static Status HowEnded(const Active& active, CURLcode done) {
    if (!active.why.empty()) return Fail(ErrorCode::kStorage, active.why, "Check this server's disk: `rigcal fsck`.");
    if (done != CURLE_OK && active.transfer.status < 400) return Fail(Unreached(curl_easy_strerror(done)));
    return {};
  }

  void Remove(const Active& done) {
    curl_multi_remove_handle(multi_.get(), done.curl.get());
    std::erase_if(active_, [&](const auto& one) { return one.get() == &done; });
  }

  const CentreAddress& centre_;
  std::vector<Transfer>& transfers_;
  const std::size_t at_once_;
  std::size_t next_ = 0;
  Status ended_;  // good until one ended without an answer
  std::unique_ptr<CURLM, decltype(&curl_multi_cleanup)> multi_;
  std::vector<std::unique_ptr<Active>> active_;
};

}  // namespace

Status CarryOut(const CentreAddress& centre, std::vector<Transfer>& transfers, std::size_t at_once,
                const std::function<bool()>& went_on) {
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
  return Round(centre, transfers, at_once).Run(went_on);
}

}  // namespace rigcal::sites
