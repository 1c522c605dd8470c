// What stands behind a rigcal_client: one participant, one connection, and what its last call left to be read.
#pragma once

#include <chrono>
#include <exception>
#include <optional>
#include <string>

#include "client/library/include/rigcal/c_api.h"
#include "client/wire/connection.h"

struct rigcal_client {
  rigcal::wire::ParticipantOptions dds;
  std::chrono::milliseconds timeout{5000};
  rigcal::Status opened;
  std::optional<rigcal::wire::Participant> participant = {};
  std::optional<rigcal::client::Connection> connection = {};
  std::string error = {}, text = {};
  std::string id = {}, verdict = {}, drive_rule = {}, remarks = {};  // that results point to
};

namespace rigcal::client {

// Keeps the sentence of an error; the code of c_api.h.
int Conclude(rigcal_client& client, const Status& done);

// Runs `body`, which gives a Status; no exception leaves it. A client that did not open gives why.
template <typename Body>
int Guarded(rigcal_client& client, const Body& body) {
  try {
    return Conclude(client, client.opened ? body() : client.opened);
  } catch (const std::exception& thrown) {
    return Conclude(client, Fail(ErrorCode::kInternal, std::string("librigcal: ") + thrown.what(),
                                 "Too little memory, or a fault in Rigcal: report it."));
  }
}

// Null is the empty text.
[[nodiscard]] inline std::string TextOf(const char* text) { return text == nullptr ? "" : text; }
// Seconds as given, at most a week; what is no number counts as 0.
[[nodiscard]] std::chrono::milliseconds MillisecondsOf(double duration_s);
// `T` and `covariance` of docs/api.md; all zero and not known where a number of them is missing.
[[nodiscard]] rigcal_pose PoseOf(const Document& T, const Document& covariance);
// `level`: of its verdict; `told`: the document with `revision` and `drive`. The strings are the client's.
[[nodiscard]] rigcal_standing StandingOf(rigcal_client& client, const Document& level, const Document& told);

}  // namespace rigcal::client
