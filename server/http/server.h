// Serves a folder and a JSON query function over HTTP (civetweb): GET and HEAD but for logging in and orders, loopback
// by default.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/http/logins/logins.h"
#include "server/http/tls/certificate.h"

namespace rigcal::http {

struct Options {
  std::string host = "127.0.0.1";  // an address or a name; "[::1]" for IPv6, where civetweb has it (Debian's has not)
  int port = 0;                    // 0: any free port
  // By what names it is asked for besides localhost, `host` and this machine's; pages' addresses serve as well.
  std::vector<std::string> names = {};
  // Address in digits of a proxy that is trusted to say from where it was asked (client_address.h); empty: none.
  std::string proxy = {};
  bool is_open = false;   // every page says that anybody on the network can read it, as long as no login is needed
  std::string note = {};  // a sentence that every page says to everybody; empty: none
  Logins logins = {};
  Orders orders = {};                                  // taken only of those who log in
  AnswerSite answer_site = {};                         // asked by tokens of sites alone
  std::shared_ptr<Certificate> certificate = nullptr;  // with one: https only
  // Published reports, <robot>/<revision>/index.html ...: /robots/<robot>/revisions/<revision>/ shows them. Empty: no
  // file is served.
  std::filesystem::path folder;
  int request_timeout_ms = 10'000;  // for a request to arrive, and for each piece of an answer to be taken
};

// What dynamic paths answer: body and content type, or an error (kNotFound -> 404, kInvalidInput -> 400, else 503).
struct Page {
  std::string body;
  std::string content_type;
  std::string location = {};  // not empty: a temporary redirect to this path instead of the body
  bool immutable = false;     // named by its content: a browser may keep it for ever
  int status = 200;           // another one: kept by nobody
};
// `path` is decoded and normalised ("/", "/robots/x/", "/api/v1/robots", "/metrics", "/healthz"), `query` the raw query
// string. Called from server threads, several at once. Of the files of a numbered revision it is asked only for
// those that are missing: the error says why. kBusy: 503, and to be asked again after some seconds (Retry-After).
using Answer = std::function<Result<Page>(const std::string& path, const std::string& query)>;

class Server {
 public:
  // Listens when it returns. kInvalidInput: `options` have no such address; kConflict: it cannot listen there. It
  // stops, with all its connections, when it goes.
  [[nodiscard]] static Result<Server> Start(const Options& options, Answer answer);
  ~Server();
  // A server that was moved from serves nothing: the other goes on.
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  // Options::names from here on. Any thread.
  void SetNames(const std::vector<std::string>& names);
  [[nodiscard]] int port() const;  // that which was bound, also where 0 was asked for

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::http
