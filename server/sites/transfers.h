// Requests to the centre, several at a time, each on a connection of its own: over a line that loses packets one
// connection alone is slow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::sites {

struct CentreAddress {
  std::string url;           // https://HOST[:PORT]; http:// of this machine alone
  std::string token;         // of the role site, made at the centre
  std::filesystem::path ca;  // PEM of who vouches for the centre's certificate; empty: who the system trusts
};

struct Transfer {
  std::string method;  // GET, POST, PUT
  std::string path;    // behind the address
  std::string body = {};
  std::filesystem::path file = {};  // instead of `body`
  std::int64_t file_bytes = 0;
  // What came of it.
  int status = 0;
  std::string reply = {};
};

// Carries all out, at most `at_once` at a time, and goes on until each was answered with whatever status; `went_on` is
// called at least once a second, and its false ends all. kUnreachable says why there was no answer; the first such, or
// an answer other than 200, lets no other begin. kStorage names a file that cannot be read.
[[nodiscard]] Status CarryOut(const CentreAddress& centre, std::vector<Transfer>& transfers, std::size_t at_once,
                              const std::function<bool()>& went_on);

}  // namespace rigcal::sites
