// Writers of replies, one per partition that asks. Thread Q only.
#pragma once

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

 private:
  using Writer = wire::Writer<rigcal_wire_Reply>;
  [[nodiscard]] Result<Writer*> WriterOf(const std::string& partition);

  const wire::Participant& participant_;
  wire::WaitSet& waitset_;
  std::map<std::string, Writer> writers_;
};

}  // namespace rigcal::dds
