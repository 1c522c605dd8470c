// A capture session on the wire: SessionHeader, Manifest, Chunks; its files are read in pieces as they are sent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/wire/push_engine.h"
#include "client/wire/transfer.h"
#include "server/base/files/file_descriptor.h"
#include "server/model/sessions/session.h"

namespace rigcal::client {

// As a file was when its folder was looked at.
struct FileMark {
  std::int64_t size_bytes = 0, modified_ns = 0;
  std::uint64_t inode = 0;
  friend bool operator==(const FileMark&, const FileMark&) = default;
};
// By path relative to the folder. Mark before hashing: then a change during or after it shows.
using FileMarks = std::map<std::string, FileMark>;
// Of all files below `folder`; what cannot be read is left out.
[[nodiscard]] FileMarks MarkFiles(const std::filesystem::path& folder);

// A file that changed since it was hashed is noticed and named.
class FilePieces {
 public:
  // `payloads` of the files in `folder`, in the manifest's order; `marks` as of MarkFiles.
  FilePieces(std::filesystem::path folder, std::vector<Payload> payloads, FileMarks marks);
  // Valid until the next call. One file is open at a time.
  [[nodiscard]] Result<const std::string*> Read(const ChunkAt& chunk);
  // The first file that is not as it was.
  [[nodiscard]] Status CheckAll() const;

 private:
  [[nodiscard]] Status Check(std::uint32_t payload_idx) const;
  [[nodiscard]] Error Changed(std::uint32_t payload_idx) const;

  std::filesystem::path folder_;
  std::vector<Payload> payloads_;
  FileMarks marks_;
  std::optional<FileDescriptor> file_;
  std::uint32_t open_idx_ = 0;
  std::string piece_;
};

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
