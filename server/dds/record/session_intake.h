// One session that is being received: which payloads are held, which are on their way, what to tell the client.
// Thread W only (TouchedParts may be flushed on others).
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "idl/convert.h"
#include "server/dds/intake/arrival.h"
#include "server/dds/record/part_file.h"
#include "server/model/sessions/session.h"

namespace rigcal::dds {

class SessionIntake {
 public:
  // `folder` exists and is empty; `held` has one bit per payload of the manifest.
  SessionIntake(const RobotId& robot, const SessionId& session, const Manifest& manifest, const std::vector<bool>& held,
                std::filesystem::path folder, std::uint64_t incarnation);

  // A piece outside of the manifest is a complaint in the next receipt; one that is not needed any more is ignored.
  void Add(ChunkBytes& chunk);
  void AddDiscarded(const DiscardedChunk& chunk);

  // Parts that Add gave something to since the last call.
  [[nodiscard]] std::vector<std::uint32_t> TakeTouched();
  [[nodiscard]] PartFile& Part(std::uint32_t payload_idx) { return parts_.at(payload_idx); }
  [[nodiscard]] const Digest& DigestOf(std::uint32_t payload_idx) const { return wanted_[payload_idx].digest; }

  // The part has the right hash; its file is the caller's from now on.
  void MarkFinished(std::uint32_t payload_idx);
  // Its bytes are useless: the file is removed, the client may send it again.
  void Drop(std::uint32_t payload_idx, Error complaint);
  // Durable, and with it every payload of the same content. Gives all that became held.
  std::vector<std::uint32_t> WithSameContent(std::uint32_t payload_idx) const;
  void MarkHeld(const std::vector<std::uint32_t>& payload_idx);
  // Whether the store has lost a payload since it became held; `held`: as stored.
  [[nodiscard]] bool HoldsMoreThan(const std::vector<bool>& held) const;

  // Every payload of the manifest is durable.
  [[nodiscard]] bool AllHeld() const { return held_count_ == wanted_.size(); }
  // True if these would be the last.
  [[nodiscard]] bool Completes(const std::set<std::uint32_t>& payload_idx) const;
  [[nodiscard]] wire::Receipt ReceiptOf(wire::ReceiptState state, std::int64_t window_bytes) const;

  // As it was made with; payloads() counts those of the manifest.
  [[nodiscard]] const RobotId& robot() const { return robot_; }
  [[nodiscard]] const SessionId& session() const { return session_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::size_t payloads() const { return wanted_.size(); }

  std::uint64_t last_used = 0;  // of the owner: larger is later
  const std::chrono::steady_clock::time_point began_at = std::chrono::steady_clock::now();

 private:
  enum class State : std::uint8_t { kWanted, kFinished, kHeld };
  struct Wanted {
    Digest digest;
    std::uint64_t size_bytes = 0;
    State state = State::kWanted;
  };
  using At = std::pair<std::uint32_t, std::uint64_t>;

  [[nodiscard]] Status CheckBounds(const ChunkBytes& chunk) const;

  RobotId robot_;
  SessionId session_;
  std::filesystem::path folder_;
  std::uint64_t incarnation_;
  std::vector<Wanted> wanted_;
  std::size_t held_count_ = 0;
  std::unordered_map<Digest, std::vector<std::uint32_t>> repeated_;  // contents that the manifest lists more than once
  std::map<std::uint32_t, PartFile> parts_;
  std::set<std::uint32_t> touched_;
  std::set<At> busy_;  // until they come again: only the newest receipt is sure to be seen
  std::uint64_t written_bytes_ = 0;
  std::map<std::uint32_t, Error> complaints_;  // until the payload is held
};

}  // namespace rigcal::dds
