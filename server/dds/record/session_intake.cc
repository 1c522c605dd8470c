#include "server/dds/record/session_intake.h"

#include <algorithm>

#include "server/base/limits.h"
#include "server/dds/tell/receipts.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kUnfinishedPartsMax = 4'096;
constexpr std::size_t kBusyMax = 65'536;
constexpr std::size_t kComplaintsMax = 64;
constexpr std::uint32_t kNoPayload = UINT32_MAX;

}  // namespace

SessionIntake::SessionIntake(const RobotId& robot, const SessionId& session, const Manifest& manifest,
                             const std::vector<bool>& held, std::filesystem::path folder, std::uint64_t incarnation)
    : robot_(robot), session_(session), folder_(std::move(folder)), incarnation_(incarnation) {
  std::unordered_map<Digest, std::vector<std::uint32_t>> by_content;
  for (std::uint32_t i = 0; i < manifest.payloads.size(); ++i) {
    const Payload& payload = manifest.payloads[i];
    const bool is_held = i < held.size() && held[i];
    wanted_.push_back(
        {payload.digest, static_cast<std::uint64_t>(payload.size_bytes), is_held ? State::kHeld : State::kWanted});
    held_count_ += is_held ? 1 : 0;
    by_content[payload.digest].push_back(i);
  }
  for (auto& [digest, idx] : by_content)
    if (idx.size() > 1) repeated_.emplace(digest, std::move(idx));
}

Status SessionIntake::CheckBounds(const ChunkBytes& chunk) const {
  const bool known = chunk.payload_idx < wanted_.size();
  const std::uint64_t size_bytes = known ? wanted_[chunk.payload_idx].size_bytes : 0;
  if (known && chunk.offset_bytes <= size_bytes && chunk.bytes.size() <= size_bytes - chunk.offset_bytes) return {};
  return Fail(ErrorCode::kInvalidInput,
              "a chunk at byte " + std::to_string(chunk.offset_bytes) + " of payload " +
                  std::to_string(chunk.payload_idx) + " lies outside of what the manifest lists",
              "Push the session again with `rigcal push` of this version");
}

void SessionIntake::Add(ChunkBytes& chunk) {
  written_bytes_ += chunk.bytes.size();
  busy_.erase({chunk.payload_idx, chunk.offset_bytes});
  if (const Status inside = CheckBounds(chunk); !inside) {
    complaints_.insert_or_assign(kNoPayload, inside.error());
    return;
  }
  const Wanted& wanted = wanted_[chunk.payload_idx];
  if (wanted.state != State::kWanted) return;
  auto part = parts_.find(chunk.payload_idx);
  if (part == parts_.end() && parts_.size() >= kUnfinishedPartsMax) {
    written_bytes_ -= chunk.bytes.size();
    return AddDiscarded({chunk.robot, chunk.session, chunk.payload_idx, chunk.offset_bytes});
  }
  if (part == parts_.end()) {
    const auto path = folder_ / (std::to_string(chunk.payload_idx) + ".part");
    part = parts_.try_emplace(chunk.payload_idx, path, wanted.size_bytes).first;
  }
  part->second.Add(chunk.offset_bytes, std::move(chunk.bytes));
  touched_.insert(chunk.payload_idx);
}

void SessionIntake::AddDiscarded(const DiscardedChunk& chunk) {
  if (chunk.payload_idx < wanted_.size() && wanted_[chunk.payload_idx].state == State::kWanted &&
      busy_.size() < kBusyMax)
    busy_.emplace(chunk.payload_idx, chunk.offset_bytes);
}

std::vector<std::uint32_t> SessionIntake::TakeTouched() {
  std::vector<std::uint32_t> touched(touched_.begin(), touched_.end());
  touched_.clear();
  return touched;
}

void SessionIntake::MarkFinished(std::uint32_t payload_idx) {
  wanted_[payload_idx].state = State::kFinished;
  parts_.erase(payload_idx);
}

void SessionIntake::Drop(std::uint32_t payload_idx, Error complaint) {
  std::error_code ignored;
  std::filesystem::remove(Part(payload_idx).path(), ignored);
  parts_.erase(payload_idx);
  if (complaints_.size() < kComplaintsMax)
    complaints_.insert_or_assign(payload_idx, ToldToClient(std::move(complaint)));
}

std::vector<std::uint32_t> SessionIntake::WithSameContent(std::uint32_t payload_idx) const {
  const auto same = repeated_.find(wanted_[payload_idx].digest);
  if (same == repeated_.end()) return {payload_idx};
  return same->second;
}

void SessionIntake::MarkHeld(const std::vector<std::uint32_t>& payload_idx) {
  for (const std::uint32_t idx : payload_idx) {
    if (wanted_[idx].state == State::kHeld) continue;
    wanted_[idx].state = State::kHeld;
    ++held_count_;
    complaints_.erase(idx);
    busy_.erase(busy_.lower_bound({idx, 0}), busy_.lower_bound({idx + 1, 0}));
    const auto part = parts_.find(idx);
    if (part == parts_.end()) continue;
    std::error_code ignored;
    std::filesystem::remove(part->second.path(), ignored);
    parts_.erase(part);
    touched_.erase(idx);
  }
}

bool SessionIntake::HoldsMoreThan(const std::vector<bool>& held) const {
  for (std::size_t i = 0; i < wanted_.size(); ++i)
    if (wanted_[i].state == State::kHeld && !(i < held.size() && held[i])) return true;
  return false;
}

bool SessionIntake::Completes(const std::set<std::uint32_t>& payload_idx) const {
  const auto is_new = [&](std::uint32_t idx) { return wanted_[idx].state != State::kHeld; };
  return held_count_ + static_cast<std::size_t>(std::count_if(payload_idx.begin(), payload_idx.end(), is_new)) ==
         wanted_.size();
}

wire::Receipt SessionIntake::ReceiptOf(wire::ReceiptState state, std::int64_t window_bytes) const {
  wire::Receipt receipt;
  receipt.robot = robot_;
  receipt.subject_id = session_.str();
  receipt.state = state;
  receipt.incarnation = incarnation_;
  receipt.window_bytes = static_cast<std::uint64_t>(window_bytes);
  receipt.written_bytes = written_bytes_;
  for (const Wanted& wanted : wanted_) receipt.held.push_back(wanted.state == State::kHeld);
  for (const auto& [payload_idx, offset_bytes] : busy_) receipt.busy.push_back({payload_idx, offset_bytes});
  if (!complaints_.empty()) receipt.error = complaints_.begin()->second;
  return receipt;
}

}  // namespace rigcal::dds
