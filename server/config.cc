#include "server/config.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "server/base/version.h"

namespace rigcal {

std::filesystem::path DefaultData() {
  if (const char* home = std::getenv("HOME")) return std::filesystem::path(home) / ".local/share/rigcal";
  return "rigcal-data";
}

void AddOptions(CLI::App& app, Config& config) {
  app.set_version_flag("--version", "rigcald " + std::string(Version()));
  app.add_option("--data", config.data, "Data folder; made if it is not there")->capture_default_str();
  app.add_option("--http", config.http, "HOST:PORT of the reports; port 0 takes a free one")->capture_default_str();
  app.add_option("--domain", config.participant.domain, "DDS domain")->capture_default_str()->check(CLI::Range(0, 230));
  app.add_option("--tag", config.participant.tag, "DDS discovery tag: only peers with the same tag meet");
  app.add_option("--threads", config.threads, "Threads that calibrate")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  app.add_flag("--verbose", config.verbose, "Log every event");
  app.footer(
      "Examples:\n  rigcald\n  rigcald --data /srv/rigcal --http 0.0.0.0:8420\n  rigcald --domain 7 --http "
      "127.0.0.1:0");
}

Result<http::Options> HttpOptions(const Config& config) {
  http::Options options;
  const std::size_t colon = config.http.rfind(':');
  const std::string port = colon == std::string::npos ? "" : config.http.substr(colon + 1);
  if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos ||
      std::stoi(port) > 65535)
    return Fail(ErrorCode::kInvalidInput, "--http '" + config.http + "' is not HOST:PORT",
                "Write, for instance, 127.0.0.1:8420.");
  options.host = config.http.substr(0, colon);
  options.port = std::stoi(port);
  options.folder = config.data / "reports";
  return options;
}

}  // namespace rigcal
