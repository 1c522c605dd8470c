#include "client/wire/session_outlet.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "server/base/digests/sha256.h"
#include "server/base/version.h"
#include "server/formats/documents.h"

namespace rigcal::client {
namespace {

// The sample borrows the bytes: DDS only reads them while it writes.
template <typename Sequence>
void Borrow(const std::string& bytes, Sequence& sequence) {
  sequence._maximum = sequence._length = static_cast<std::uint32_t>(bytes.size());
  sequence._buffer = const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data()));
  sequence._release = false;
}

template <typename Sample>
Status Name(const SessionToPush& session, Sample& sample) {
  RIGCAL_TRY(wire::CopyText(session.robot.str(), sample.robot_id, sizeof(sample.robot_id), "robot id"));
  return wire::CopyText(session.id.str(), sample.session_id, sizeof(sample.session_id), "session id");
}

}  // namespace

namespace fs = std::filesystem;
namespace {

std::optional<FileMark> MarkOf(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FileMark{info.st_size, info.st_mtim.tv_sec * 1'000'000'000LL + info.st_mtim.tv_nsec, info.st_ino};
}

// Reads exactly piece.size() bytes; false at an early end or an error.
bool ReadAt(int file, std::uint64_t offset_bytes, std::string& piece) {
  std::size_t done = 0;
  while (done < piece.size()) {
    const ssize_t count =
        ::pread(file, piece.data() + done, piece.size() - done, static_cast<off_t>(offset_bytes + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

FileMarks MarkFiles(const fs::path& folder) {
  FileMarks marks;
  std::error_code error;
  auto item = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && item != fs::recursive_directory_iterator(); item.increment(error))
    if (const auto mark = MarkOf(item->path())) marks[item->path().lexically_relative(folder).generic_string()] = *mark;
  return marks;
}

FilePieces::FilePieces(fs::path folder, std::vector<Payload> payloads, FileMarks marks)
    : folder_(std::move(folder)), payloads_(std::move(payloads)), marks_(std::move(marks)) {}

Error FilePieces::Changed(std::uint32_t payload_idx) const {
  return {
      ErrorCode::kInvalidInput,
      (folder_ / payloads_[payload_idx].path).string() + " changed, or can no longer be read, while it was being sent",
      "Let nothing write to the folder, then push it again: what is already on the server is not sent twice"};
}

Status FilePieces::Check(std::uint32_t payload_idx) const {
  const Payload& payload = payloads_[payload_idx];
  const auto before = marks_.find(payload.path);
  const auto now = MarkOf(folder_ / payload.path);
  if (before == marks_.end() || !now || *now != before->second || now->size_bytes != payload.size_bytes)
    return Fail(Changed(payload_idx));
  return {};
}

Status FilePieces::CheckAll() const {
  for (std::uint32_t i = 0; i < payloads_.size(); ++i) RIGCAL_TRY(Check(i));
  return {};
}

Result<const std::string*> FilePieces::Read(const ChunkAt& chunk) {
  if (!file_ || open_idx_ != chunk.payload_idx) {
    file_.reset();
    RIGCAL_ASSIGN(FileDescriptor file, OpenToRead(folder_ / payloads_[chunk.payload_idx].path));
    file_.emplace(std::move(file));
    open_idx_ = chunk.payload_idx;
  }
  piece_.resize(chunk.size_bytes);
  const bool is_whole = ReadAt(file_->get(), chunk.offset_bytes, piece_);
  RIGCAL_TRY(Check(chunk.payload_idx));
  if (!is_whole) return Fail(Changed(chunk.payload_idx));
  return &piece_;
}

SessionToPush SessionOf(const Manifest& manifest) {
  SessionToPush session;
  session.robot = manifest.header.robot;
  session.manifest = formats::WriteManifest(manifest);
  session.id = SessionId(Sha256Of(session.manifest).str());
  session.payloads = manifest.payloads;
  for (const Payload& payload : manifest.payloads) session.total_bytes += payload.size_bytes;
  return session;
}

SessionOutlet::SessionOutlet(const SessionToPush& session, FilePieces pieces,
                             wire::Writer<rigcal_wire_SessionHeader> headers,
                             wire::Writer<rigcal_wire_Manifest> manifests, wire::Writer<rigcal_wire_Chunk> chunks)
    : session_(session),
      pieces_(std::move(pieces)),
      headers_(std::move(headers)),
      manifests_(std::move(manifests)),
      chunks_(std::move(chunks)) {}

Result<std::unique_ptr<SessionOutlet>> SessionOutlet::Open(const wire::Participant& participant,
                                                           const SessionToPush& session, FilePieces pieces) {
  const std::vector<std::string> partition = {wire::RobotPartition(session.robot)};
  RIGCAL_ASSIGN(auto headers, wire::Writer<rigcal_wire_SessionHeader>::Open(participant, partition));
  RIGCAL_ASSIGN(auto manifests, wire::Writer<rigcal_wire_Manifest>::Open(participant, partition));
  RIGCAL_ASSIGN(auto chunks, wire::Writer<rigcal_wire_Chunk>::Open(participant, partition));
  return std::unique_ptr<SessionOutlet>(
      new SessionOutlet(session, std::move(pieces), std::move(headers), std::move(manifests), std::move(chunks)));
}

bool SessionOutlet::HasServer() const {
  return headers_.MatchedReaders() > 0 && manifests_.MatchedReaders() > 0 && chunks_.MatchedReaders() > 0;
}

std::vector<dds_entity_t> SessionOutlet::Writers() const { return {headers_.get(), manifests_.get(), chunks_.get()}; }

Status SessionOutlet::SendHeader(const PushEngine&) {
  rigcal_wire_SessionHeader header{};
  RIGCAL_TRY(Name(session_, header));
  RIGCAL_TRY(wire::CopyText(std::string(Version()), header.client_version, sizeof(header.client_version), "version"));
  header.protocol = kWireProtocol;
  header.payload_count = static_cast<std::uint32_t>(session_.payloads.size());
  header.manifest_bytes = session_.manifest.size();
  header.total_bytes = static_cast<std::uint64_t>(session_.total_bytes);
  return headers_.Write(header);
}

Status SessionOutlet::SendManifest() {
  rigcal_wire_Manifest manifest{};
  RIGCAL_TRY(Name(session_, manifest));
  Borrow(session_.manifest, manifest.bytes);
  return manifests_.Write(manifest);
}

Status SessionOutlet::SendChunk(const ChunkAt& at) {
  rigcal_wire_Chunk chunk{};
  RIGCAL_TRY(Name(session_, chunk));
  RIGCAL_ASSIGN(const std::string* bytes, pieces_.Read(at));
  chunk.payload_idx = at.payload_idx;
  chunk.offset_bytes = at.offset_bytes;
  Borrow(*bytes, chunk.bytes);
  return chunks_.Write(chunk);
}

}  // namespace rigcal::client
