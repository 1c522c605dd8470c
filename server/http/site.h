// What all threads of one server share.
#pragma once

#include <civetweb.h>

#include <filesystem>
#include <memory>

#include "server/http/allowed_hosts.h"
#include "server/http/compressed_bodies.h"
#include "server/http/header_gate.h"
#include "server/http/server.h"

namespace rigcal::http {

struct Site {
  std::filesystem::path folder;
  Answer answer;
  AllowedHosts hosts;
  bool is_open = false;  // Options::is_open
  std::shared_ptr<Certificate> certificate;  // null: plain HTTP
  std::unique_ptr<HeaderGate> gate;
  std::unique_ptr<CompressedBodies> compressed;
};

[[nodiscard]] inline const Site& SiteOf(const mg_connection* connection) {
  return *static_cast<const Site*>(mg_get_user_data(mg_get_context(connection)));
}

}  // namespace rigcal::http
