// What all threads of one server share.
#pragma once

#include <civetweb.h>

#include <filesystem>
#include <memory>

#include "server/base/process/guarded.h"
#include "server/http/allowed_hosts.h"
#include "server/http/compressed_bodies.h"
#include "server/http/connections/header_gate.h"
#include "server/http/logins/known_browsers.h"
#include "server/http/logins/login_throttle.h"
#include "server/http/logins/logins.h"
#include "server/http/server.h"

namespace rigcal::http {

struct Site {
  std::filesystem::path folder;
  Answer answer;
  std::unique_ptr<HostsInForce> hosts;
  std::string proxy;                         // Options::proxy
  bool is_open = false;                      // Options::is_open
  std::string note;                          // Options::note
  std::shared_ptr<Certificate> certificate;  // null: plain HTTP
  Logins logins;
  Orders orders;
  AnswerSite answer_site;
  std::unique_ptr<LoginThrottle> throttle;
  std::unique_ptr<KnownBrowsers> known;
  std::unique_ptr<HeaderGate> gate;
  std::unique_ptr<CompressedBodies> compressed;
};

[[nodiscard]] inline const Site& SiteOf(const mg_connection* connection) {
  return *static_cast<const Site*>(mg_get_user_data(mg_get_context(connection)));
}

// What it asks was read whole: from now on only who takes no answer is put out.
inline void NoteHeard(const mg_connection* connection) {
  const mg_request_info* request = mg_get_request_info(connection);
  if (request) OnceThereIsMemory([&] { SiteOf(connection).gate->Heard({request->remote_addr, request->remote_port}); });
}

}  // namespace rigcal::http
