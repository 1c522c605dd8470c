// A DDS type of which only the name is known: a sample is the serialised bytes as they are on the wire, their four
// bytes of encapsulation included. It has no keys and no description: readers and writers match by its name, as those
// of ROS 2 do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

struct ddsi_sertype;
struct ddsi_serdata;

namespace rigcal::wire::internal {

// One reference, which dds_create_topic_sertype takes over.
[[nodiscard]] ddsi_sertype* NewCdrType(const std::string& type_name);
// A sample with these bytes, copied; one reference, which dds_writecdr takes over. Null: no memory.
[[nodiscard]] ddsi_serdata* NewCdrSample(const ddsi_sertype* type, std::span<const std::byte> bytes) noexcept;
// Of a sample of such a type, until it is released; with what the sender added to fill the last word.
[[nodiscard]] std::span<const std::byte> CdrBytesOf(const ddsi_serdata* sample);
// The writer's number of it, from 1 on without gaps; 0: not known (a writer of this process).
[[nodiscard]] std::int64_t SequenceOf(const ddsi_serdata* sample);

}  // namespace rigcal::wire::internal
