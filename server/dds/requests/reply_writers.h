// Writers of replies, one per partition that asks. Thread Q only.
#pragma once

#include <chrono>
#include <map>
#include <string>

#include "idl/dds.h"

namespace rigcal::dds {

class ReplyWriters {
 public:
  // Both outlive it. The wait set wakes when a reader of replies comes or goes.
  ReplyWriters(const wire::Participant& participant, wire::WaitSet& waitset)
      : participant_(participant), waitset_(waitset) {}

  // Makes the writer of a partition, so that a client can find it before it asks.
  [[nodiscard]] Status Add(const std::string& partition);
  // One part of a reply, in the partition where the request came from ("operator" or "robot/<id>"). kUnreachable if the
  // participant that asked has no matched reader yet; kBusy if its reader does not take.
  [[nodiscard]] Status Send(const std::string& partition, dds_instance_handle_t participant,
                            const rigcal_wire_Reply& part);
  // Ends the writers of robots' partitions in which nobody has read replies for a while. Again and again.
  void CloseQuiet();

 private:
  using Writer = wire::Writer<rigcal_wire_Reply>;
  using Time = std::chrono::steady_clock::time_point;
  struct Kept {
    Writer writer;
    Time quiet_since;
  };
  [[nodiscard]] Result<Kept*> WriterOf(const std::string& partition);

  const wire::Participant& participant_;
  wire::WaitSet& waitset_;
  std::map<std::string, Kept> writers_;
  Time next_look_{};  // for quiet ones
};

}  // namespace rigcal::dds
