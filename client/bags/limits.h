// What reading a bag may take. Beyond a limit is refused by name, never cut (docs/bags.md lists them).
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigcal::bags::limits {

constexpr std::uint64_t kRecordBytesMax = 192ULL << 20;    // one record, and one compressed chunk
constexpr std::uint64_t kChunkBytesMax = 192ULL << 20;     // one compressed chunk, unpacked
constexpr std::uint64_t kPackedFileBytesMax = 1ULL << 40;  // a compressed file, unpacked
constexpr std::size_t kTopicsMax = 10'000;                 // topics, channels or connections of one bag
constexpr std::size_t kDefinitionBytesMax = 1 << 20;       // of one message type
constexpr std::size_t kDefinitionsBytesMax = 64 << 20;     // of all topics of one file
constexpr std::size_t kDamageToldMax = 20;                 // sentences about one bag; what is beyond is counted
constexpr std::size_t kPartsMax = 10'000;                  // files of a split bag
constexpr std::size_t kMetadataBytesMax = 16 << 20;        // metadata.yaml
constexpr std::size_t kTypesMax = 2'000;                   // message types that one definition names
constexpr std::size_t kFieldsMax = 10'000;                 // of all types of one definition
constexpr std::size_t kNestingMax = 32;                    // messages within messages
constexpr std::size_t kValuesMax = 1'000'000;              // of one decoded message, arrays of numbers counted as one
constexpr std::int64_t kPictureSideMax = 65'535;           // pixels
constexpr std::int64_t kCloudPointsMax = 5'000'000;        // points of one cloud

}  // namespace rigcal::bags::limits
