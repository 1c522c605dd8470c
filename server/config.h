// What rigcald is told on its command line, and what it does without being told.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "idl/dds.h"
#include "server/base/limits_in_force.h"
#include "server/http/server.h"
#include "server/sites/transfers.h"
#include "server/webhook/post.h"
#include "storage/store_place.h"

namespace CLI {
class App;
}

namespace rigcal {

struct Config {
  std::filesystem::path data;
  std::string file;           // of options, where --config names no other; empty: none
  std::string store;          // --store; empty: in data
  std::string blobs;          // --blobs; empty: in data
  storage::StorePlace place;  // what these say, after SettlePlace
  std::string http = "127.0.0.1:8420";
  bool http_open = false;  // http may be an address that others on the network reach, without TLS and a login
  std::vector<std::string> http_names;
  std::string http_proxy;                     // empty: none
  std::filesystem::path http_cert, http_key;  // both or neither: https
  std::string public_url;                     // empty: of http
  wire::ParticipantOptions participant;
  int threads = 2;
  bool verbose = false;
  std::string log = "text";  // or "json"
  bool standby = false;      // waits while another server is there, instead of ending
  bool worker = false;       // works for a server that started it (pipeline/workers/worker.h), and serves nobody
  std::filesystem::path limits_file;                   // empty: none
  std::vector<std::string> limits;                     // NAME=VALUE; they win over the file
  std::vector<std::string> webhooks;                   // addresses that are told of changes
  std::vector<std::filesystem::path> webhook_secrets;  // one for all of them, or one for each in their order
  std::string centre;                                  // where what robots push is sent on to; empty: nowhere
  std::filesystem::path centre_token, centre_ca;       // files; `centre_ca` empty: who the system trusts
};

// $HOME/.local/share/rigcal.
[[nodiscard]] std::filesystem::path DefaultData();
void AddOptions(CLI::App& app, Config& config);
// Those of rigcal-worker.
void AddWorkerOptions(CLI::App& app, Config& config);
// kInvalidInput where nobody would calibrate: no threads, and a store that this process has for itself.
[[nodiscard]] Status CheckThreads(const Config& config);
// Works out where the store is; `data` becomes its folder. A process that this one starts finds the same store by its
// environment, where no password shows. kInvalidInput names what is wrong with --store.
[[nodiscard]] Status SettlePlace(Config& config);
// kInvalidInput if --http is not HOST:PORT, a --http-name is no host's name, others would reach it without TLS and
// --http-open does not say that they may, or the files of --http-cert and --http-key are not what they should be.
[[nodiscard]] Result<http::Options> HttpOptions(const Config& config);
// By what names browsers may ask for this server: those of --http-name and of --public-url.
[[nodiscard]] std::vector<std::string> NamesOf(const Config& config);
// Whether others reach the address of `options` and --http-open does not say that they may read without a login: then
// they need one, also where the last user is removed while the server runs.
[[nodiscard]] bool AlwaysNeedsLogin(const Config& config, const http::Options& options);
// kInvalidInput if it is so, and nobody could log in.
[[nodiscard]] Status CheckUsers(const Config& config, const http::Options& options, bool has_users);
// Says in the log what strangers on the network can read, at `address`, and what they can do over DDS.
void WarnOfReach(const http::Options& options, const std::string& address, bool has_users);
// --public-url as http/public_address.h reads it; empty where it is not given.
[[nodiscard]] Result<std::string> PublicUrl(const Config& config);
// kInvalidInput names the limit, and the file and line where it was read. The defaults where nothing is given; of
// decoded_bytes half of the memory that the process may have, if that is less.
[[nodiscard]] Result<limits::Limits> LimitsOf(const Config& config);
// By what name and arguments this program works for the server that has this configuration, with the limits in force: a
// file of limits that is changed meanwhile is not read.
[[nodiscard]] std::vector<std::string> WorkerCommand(const Config& config);
// --webhook with its secret, as webhook/post.h takes it. kInvalidInput where secrets are missing or too many.
[[nodiscard]] Result<std::vector<webhook::Receiver>> ReceiversOf(const Config& config);
// --centre with its token, as sites/centre_link.h takes it; an empty address where it is not given. kInvalidInput where
// it is no address, the token is missing or others on this machine can read it.
[[nodiscard]] Result<sites::CentreAddress> CentreOf(const Config& config);
// Puts them in force, before any thread is made; the log tells of those that are not the default.
[[nodiscard]] Status EnforceLimits(const Config& config);

}  // namespace rigcal
