#include "server/http/server.h"

#include <civetweb.h>

#include <array>
#include <chrono>
#include <cstring>
#include <future>

#include "server/base/limits.h"
#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/base/text.h"
#include "server/http/connections/client_address.h"
#include "server/http/connections/worker_stack.h"
#include "server/http/error_body.h"
#include "server/http/forwarded.h"
#include "server/http/guarded.h"
#include "server/http/logins/entrance.h"
#include "server/http/orders.h"
#include "server/http/public_address.h"
#include "server/http/reply.h"
#include "server/http/request_path.h"
#include "server/http/site.h"
#include "server/http/static_file.h"

namespace rigcal::http {
namespace {

AllowedHosts HostsOf(const std::string& host, const std::vector<std::string>& others) {
  std::vector<std::string> names = NamesOfMachine(MachineName());
  names.push_back(host);
  names.insert(names.end(), others.begin(), others.end());
  return AllowedHosts(names);
}

Caller CallerOf(const mg_request_info& request) {
  Caller caller;
  caller.target = request.request_uri ? request.request_uri : "";
  caller.version = request.http_version ? request.http_version : "";
  for (int i = 0; i < request.num_headers; ++i) {
    const mg_header& header = request.http_headers[i];
    if (mg_strcasecmp(header.name, "Host") == 0) caller.hosts.emplace_back(header.value);
    if (mg_strcasecmp(header.name, "Origin") == 0) caller.origins.emplace_back(header.value);
  }
  return caller;
}

bool MayRead(const char* method) { return std::strcmp(method, "GET") == 0 || std::strcmp(method, "HEAD") == 0; }

Result<Page> Ask(const Site& site, const std::string& path, const std::string& query) {
  return Guarded(path, [&] { return site.answer(path, query); });
}

// `file`: "<robot>/<number>/<file>".
std::string MissingText(const std::string& file) {
  const std::size_t number = file.find('/') + 1, name = file.find('/', number) + 1;
  const std::string report = "revision " + file.substr(number, name - 1 - number) + " of " + file.substr(0, number - 1);
  const bool is_page = file.substr(name) == "index.html";
  return is_page ? "there is no report of " + report : "the report of " + report + " has no file " + file.substr(name);
}

// A browser comes back by itself to what will be there soon.
int SendFailure(mg_connection* connection, const Error& error, bool as_json) {
  const int status = StatusOf(error.code);
  if (error.code != ErrorCode::kBusy) return SendError(connection, status, error, as_json);
  return SendError(connection, status, error, as_json, {{"Retry-After", "2"}, {"Refresh", "2"}});
}

int ServeFile(mg_connection* connection, const Site& site, const std::string& path, const std::string& file) {
  const int status = SendFile(connection, site.folder, file);
  if (status != 404) return status;
  const auto why = Ask(site, path, "");
  const Error missing{ErrorCode::kNotFound, MissingText(file), "Start at the list of robots."};
  return SendFailure(connection, why ? missing : why.error(), false);
}

int ServePath(mg_connection* connection, const Site& site, const std::string& path, const std::string& query) {
  if (const auto address = WithSlash(path)) return SendRedirect(connection, 301, *address);
  if (const auto file = PublishedFile(path)) return ServeFile(connection, site, path, *file);
  const auto page = Ask(site, path, query);
  if (!page) return SendFailure(connection, page.error(), IsApi(path));
  if (!page->location.empty()) return SendRedirect(connection, 302, page->location);
  if (page->status != 200) return SendOnce(connection, page->status, page->body, page->content_type);
  return SendBody(connection, page->body, page->content_type, page->immutable);
}

int SendMethods(mg_connection* connection, const char* method, const std::string& path) {
  return SendError(connection, 405,
                   {ErrorCode::kInvalidInput, std::string(method) + " is not answered here",
                    "Use GET or HEAD; data goes in with `rigcal push`."},
                   IsApi(path), {{"Allow", "GET, HEAD"}});
}

int Serve(mg_connection* connection, const Site& site, Visit& visit) {
  const mg_request_info* request = mg_get_request_info(connection);
  const auto needs_login = AreLoginsNeeded(site.logins);
  visit.needs_login = needs_login.value_or(true);
  // Hardly anybody reads a body: closing is what keeps a client from sending one for ever.
  if (request->content_length > 0 || mg_get_header(connection, "Transfer-Encoding")) mg_disable_keep_alive(connection);
  const std::string raw = request->local_uri_raw ? request->local_uri_raw : "";
  if (const auto refusal = RefusalOf(*site.hosts->Now(), CallerOf(*request)))
    return SendError(connection, refusal->status, refusal->error, IsApi(raw));
  const auto path = NormalPath(raw);
  if (!path) return SendError(connection, 400, path.error(), IsApi(raw));
  if (!needs_login && !IsForEverybody(*path)) return SendFailure(connection, needs_login.error(), IsApi(*path));
  if (const auto answered = AnswerForwarded(connection, *path)) return *answered;
  if (visit.needs_login)
    if (const auto answered = Admit(connection, *path, visit)) return *answered;
  if (const auto answered = AnswerOrder(connection, *path, visit)) return *answered;
  if (!MayRead(request->request_method)) return SendMethods(connection, request->request_method, *path);
  return ServePath(connection, site, *path, request->query_string ? request->query_string : "");
}

}  // namespace

namespace {

// civetweb looks at its stop flag when a client comes, or every 2 s: so a client comes.
void Stop(mg_context* context, const std::string& host, int port) {
  std::array<char, 128> ignored{};
  std::future<void> stopped = std::async(std::launch::async, [context] { mg_stop(context); });
  while (stopped.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready)
    if (mg_connection* knock = mg_connect_client(host.c_str(), port, 0, ignored.data(), ignored.size()))
      mg_close_connection(knock);
}

}  // namespace

struct Server::Impl {
  std::string host;
  Site site;
  int port = 0;
  mg_context* context = nullptr;
  explicit Impl(Site served) : site(std::move(served)) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (context) Stop(context, host, port);
  }
};

namespace {

// Of a request with a body whoever reads that says that it was heard.
int OnRequest(mg_connection* connection) {
  if (mg_get_request_info(connection)->content_length <= 0) NoteHeard(connection);
  Visit visit;
  SetVisit(connection, &visit);
  const auto status =
      Guarded("a request", [&]() -> Result<int> { return Serve(connection, SiteOf(connection), visit); });
  SetVisit(connection, nullptr);
  if (status) return *status;
  mg_disable_keep_alive(
      connection);  // it may have begun to answer: then the rest is missing, and whoever asked is told by its length
  return 500;
}

// Before its descriptor is another's.
void OnClose(const mg_connection* connection) {
  const mg_request_info* request = mg_get_request_info(connection);
  if (request) OnceThereIsMemory([&] { SiteOf(connection).gate->Ended({request->remote_addr, request->remote_port}); });
}

// Its owner frees it.
int OnTls(void** context, void* site) {
  const auto& certificate = static_cast<const Site*>(site)->certificate;
  if (*context == nullptr && certificate) *context = certificate->context();
  return 1;
}

// The thread that accepts is number 0.
void* OnThread(const mg_context* context, int kind) {
  if (kind == 0) static_cast<const Site*>(mg_get_user_data(context))->gate->GuardThisThread();
  return nullptr;
}

// What civetweb refuses by itself (a malformed request) looks like everything else.
int OnError(mg_connection* connection, int status, const char* message) {
  NoteHeard(connection);
  static_cast<void>(Guarded("a refused request", [&]() -> Result<int> {
    return SendError(
        connection, status,
        {ErrorCode::kInvalidInput, std::string("The request was refused: ") + message, "Start at the fleet: /"}, false);
  }));
  return 0;
}

int OnLog(const mg_connection*, const char* message) {
  OnceThereIsMemory([&] { Log(LogLevel::kDebug, std::string("http: ") + message); });
  return 1;
}

Status CheckOptions(const Options& options) {
  if (!options.proxy.empty() && !PlainAddress(options.proxy))
    return Fail(ErrorCode::kInvalidInput, "the proxy " + Quoted(options.proxy) + " is not an address",
                "Give one in digits, for example 127.0.0.1.");
  const bool odd = options.host.empty() ||
                   options.host.find_first_not_of(
                       "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:[]") != std::string::npos;
  if (odd || options.port < 0 || options.port > 65535)
    return Fail(ErrorCode::kInvalidInput,
                "the HTTP address " + options.host + ":" + std::to_string(options.port) + " is not one",
                "Give HOST:PORT, for example 127.0.0.1:8080 (port 0: any free one).");
  if (options.host.front() == '[' && mg_check_feature(MG_FEATURES_IPV6) == 0)
    return Fail(ErrorCode::kInvalidInput,
                "the HTTP address " + options.host + " is of IPv6, which this system's civetweb has not",
                "Give one of IPv4; a proxy in front may listen on IPv6 (docs/security.md).");
  return {};
}

Result<mg_context*> StartContext(const Options& options, const Site& site) {
  RaiseWorkerStacks();
  static const unsigned library = mg_init_library(0);
  (void)library;
  const std::string address = options.host + ":" + std::to_string(options.port);
  const std::string port = address + (options.certificate ? "s" : "");
  const std::string threads = std::to_string(limits::InForce().http_connections);
  const std::string timeout = std::to_string(options.request_timeout_ms);
  // Without keep-alive, so that no worker waits for a request: those that wait are at the gate.
  const std::array<const char*, 19> settings = {"listening_ports",
                                                port.c_str(),
                                                "num_threads",
                                                threads.c_str(),
                                                "request_timeout_ms",
                                                timeout.c_str(),
                                                "enable_keep_alive",
                                                "no",
                                                "listen_backlog",
                                                "1024",
                                                "decode_url",
                                                "no",
                                                "enable_auth_domain_check",
                                                "no",
                                                "enable_directory_listing",
                                                "no",
                                                "tcp_nodelay",
                                                "1",
                                                nullptr};
  mg_callbacks callbacks{};
  callbacks.begin_request = OnRequest;
  callbacks.connection_close = OnClose;
  callbacks.http_error = OnError;
  callbacks.log_message = OnLog;
  callbacks.init_thread = OnThread;
  callbacks.external_ssl_ctx = OnTls;
  std::array<char, 256> text{};
  unsigned code = 0;
  mg_error_data error{&code, text.data(), text.size()};
  auto options_list = settings;
  mg_init_data init{&callbacks, const_cast<Site*>(&site), options_list.data()};
  if (mg_context* context = mg_start2(&init, &error)) return context;
  return Fail(ErrorCode::kConflict, "the HTTP server cannot listen on " + address + ": " + text.data(),
              "Stop the program that uses this port, or choose another one (port 0: any free one).");
}

}  // namespace

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() = default;
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
int Server::port() const { return impl_->port; }
void Server::SetNames(const std::vector<std::string>& names) { impl_->site.hosts->Set(HostsOf(impl_->host, names)); }

Result<Server> Server::Start(const Options& options, Answer answer) {
  RIGCAL_TRY(CheckOptions(options));
  auto impl = std::make_unique<Impl>(
      Site{options.folder, std::move(answer), std::make_unique<HostsInForce>(HostsOf(options.host, options.names)),
           options.proxy, options.is_open, options.note, options.certificate, options.logins, options.orders,
           options.answer_site, std::make_unique<LoginThrottle>(), std::make_unique<KnownBrowsers>(),
           std::make_unique<HeaderGate>(std::chrono::milliseconds(options.request_timeout_ms),
                                        static_cast<std::size_t>(limits::InForce().http_connections),
                                        options.certificate != nullptr),
           std::make_unique<CompressedBodies>(limits::kHttpCompressedBytes)});
  impl->host = options.host;
  RIGCAL_ASSIGN(impl->context, StartContext(options, impl->site));
  mg_server_port bound{};
  if (mg_get_server_ports(impl->context, 1, &bound) < 1 || bound.port <= 0)
    return Fail(ErrorCode::kInternal, "the HTTP server does not say its port", "Give a port other than 0.");
  impl->port = bound.port;
  return Server(std::move(impl));
}

}  // namespace rigcal::http
