// Every named limit of Rigcal, with its default. What is beyond a limit is refused by name, never cut.
// docs/limits.md says what happens beyond each; limits_in_force.h holds those that may be set at start-up.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigcal::limits {

constexpr std::size_t kNameMax = 64;                    // characters of an id that a person gives
constexpr std::int64_t kManifestBytesMax = 16LL << 20;  // a session's canonical manifest
constexpr std::size_t kPayloadsPerSessionMax = 100'000;
constexpr std::int64_t kPayloadBytesMax = 2LL << 30;  // one picture or cloud
constexpr std::int64_t kSessionBytesMax = 256LL << 30;
constexpr std::size_t kChunkBytesMax = 1 << 20;                  // one DDS chunk
constexpr std::int64_t kWindowBytes = 24LL << 20;                // taken but not yet written, per session
constexpr std::int64_t kIntakeBytesMax = 64LL << 20;             // the same, all sessions together
constexpr std::int64_t kIntakeWhileAskedBytesPerS = 96LL << 20;  // somewhat less than a gigabit link brings
constexpr std::int64_t kCachedBytes = 64LL << 20;                // of stored payloads that the page cache keeps
constexpr std::size_t kCameraMemoryViewsMax = 2048;              // of cameras whose estimate is remembered
constexpr std::size_t kEdgesPerBatchMax = 1'000'000;
constexpr std::size_t kSensorsPerRobotMax = 100'000;
constexpr std::size_t kSensorsPerSessionMax = 1024;  // its pairs are tried, so the square must stay small
constexpr std::size_t kTargetsPerSessionMax = 64;
constexpr std::size_t kSessionYamlBytesMax = 1 << 20;
constexpr std::size_t kRequestBytesMax = 64 << 10;
constexpr std::size_t kReplyPartBytes = 512 << 10;  // longer replies travel in parts
constexpr std::int64_t kImagePixelsMax = 200'000'000;
constexpr std::int64_t kDecodedBytes = 8LL << 30;    // of pictures and clouds that are searched or drawn
constexpr std::size_t kCloudPointsMax = 5'000'000;   // of one capture
constexpr std::size_t kCloudFieldsMax = 512;         // values of one point, x y z included
constexpr std::size_t kCloudValuesMax = 50'000'000;  // points times values of one point
constexpr std::size_t kCloudHeaderBytesMax = 64 << 10;
constexpr std::size_t kPoseTableBytesMax = 256 << 20;  // a poses.csv
constexpr std::size_t kPoseTableRowsMax = 1'000'000;
constexpr std::size_t kColouredPointsMax = 1'500'000;  // of a coloured cloud: beyond, it is thinned evenly
constexpr std::size_t kLidarPairCapturesMax = 64;      // of two lidars, held in memory at once
constexpr std::size_t kCloudCamerasMax = 64;           // that colour one cloud
constexpr std::size_t kOpenSessionsMax = 256;          // being received at once
constexpr std::size_t kHttpConnectionsMax = 64;
constexpr std::size_t kHttpWaitingMax = 384;            // connections whose request has not come whole
constexpr std::size_t kHttpWaitingOfPeerMax = 192;      // of them, from one address
constexpr std::size_t kHttpCompressedBytes = 32 << 20;  // of answers, kept in memory
constexpr std::int64_t kReportsOfRobot = 20;            // kept on disk, beside one of each month
constexpr std::size_t kG2oFileBytesMax = 1ULL << 30;
constexpr std::size_t kRevisionBytesMax = 1ULL << 30;  // of a revision's document
constexpr std::int64_t kPageRowsMax = 1'000;           // of a list that is asked for by pages
constexpr std::size_t kDigestsAskedMax = 32;           // of files, in one question whose they are
constexpr std::int64_t kRobotsComparedMax = 10'000;    // on each side of a name that no robot has

}  // namespace rigcal::limits
