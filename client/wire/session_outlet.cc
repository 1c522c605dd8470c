#include "client/wire/session_outlet.h"

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
