// A capture session on the wire: SessionHeader, Manifest, Chunks.
#pragma once

#include <memory>
#include <string>

#include "client/wire/file_pieces.h"
#include "client/wire/transfer.h"

namespace rigcal::client {

struct SessionToPush {
  RobotId robot;
  SessionId id;
  std::string manifest;  // canonical text
  std::vector<Payload> payloads;
  std::int64_t total_bytes = 0;
};
// Of the manifest as it was read: id = sha256 of its canonical text.
[[nodiscard]] SessionToPush SessionOf(const Manifest& manifest);

class SessionOutlet : public Outlet {
 public:
  // Writers of header, manifest and chunks in the robot's partition.
  [[nodiscard]] static Result<std::unique_ptr<SessionOutlet>> Open(const wire::Participant& participant,
                                                                   const SessionToPush& session, FilePieces pieces);
  [[nodiscard]] Status SendHeader(const PushEngine& engine) override;
  [[nodiscard]] Status SendManifest() override;
  [[nodiscard]] Status SendChunk(const ChunkAt& chunk) override;
  [[nodiscard]] Status CheckInput() const override { return pieces_.CheckAll(); }
  [[nodiscard]] bool HasServer() const override;
  [[nodiscard]] std::vector<dds_entity_t> Writers() const override;

 private:
  SessionOutlet(const SessionToPush& session, FilePieces pieces, wire::Writer<rigcal_wire_SessionHeader> headers,
                wire::Writer<rigcal_wire_Manifest> manifests, wire::Writer<rigcal_wire_Chunk> chunks);

  SessionToPush session_;
  FilePieces pieces_;
  wire::Writer<rigcal_wire_SessionHeader> headers_;
  wire::Writer<rigcal_wire_Manifest> manifests_;
  wire::Writer<rigcal_wire_Chunk> chunks_;
};

}  // namespace rigcal::client
