// Whether exactly one server is there: with two on a domain and tag both would store what is sent, and either may
// answer.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "idl/presence.h"

namespace rigcal::client {

// Judges what discovery lists. A server that was killed is listed for a while beside the one that takes its place, but
// only to those who met it alive: so two are believed at once by who has just come, later only if both stay.
class ServersSeen {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // `where`: named in the error; `opened_at`: when discovery began.
  ServersSeen(std::string where, Time opened_at) : where_(std::move(where)), opened_at_(opened_at) {}
  // kUnreachable names two that serve. A server that was restarted on its data folder is the same.
  [[nodiscard]] Status Judge(const std::vector<wire::ServerName>& listed, Time now);

 private:
  struct Seen {
    wire::ServerName name;
    Time since;
  };
  std::string where_;  // WhereText
  Time opened_at_;
  std::map<std::string, Seen> seen_;  // that serve now, by host and folder
};

// The same, from what a participant hears. One thread.
class OneServer {
 public:
  // Begins to listen; the others are known after a moment of discovery.
  [[nodiscard]] static Result<OneServer> Open(const wire::Participant& participant, const std::string& where);
  [[nodiscard]] Status Check();       // now
  [[nodiscard]] Status CheckOften();  // for loops: looks 20 times a second, whatever it is called

 private:
  OneServer(wire::ServerList list, ServersSeen seen) : list_(std::move(list)), seen_(std::move(seen)) {}
  wire::ServerList list_;
  ServersSeen seen_;
  ServersSeen::Time checked_at_;
};

}  // namespace rigcal::client
