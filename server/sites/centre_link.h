// What the server of a site asks its centre (docs/api.md, forward).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "server/formats/sites/forward.h"
#include "server/sites/transfers.h"

namespace rigcal::sites {

// kInvalidInput for an address that is no https:// one, nor http:// of this machine itself, that names a user or has a
// path; for an empty token.
[[nodiscard]] Status CheckCentre(const CentreAddress& centre);

// Of the errors below: nothing can be sent now.
[[nodiscard]] inline bool IsOfTheWay(ErrorCode code) {
  return code == ErrorCode::kUnreachable || code == ErrorCode::kBusy;
}

// One thread at a time. Each call returns once the centre has what was sent on its disk. kUnreachable: it was not
// reached, does not take this server's token, or cannot store now: nothing can be sent. kBusy: it has others to serve,
// and is asked for less at once. Any other error is of what was sent: the centre refuses that, or it cannot be read
// here.
class CentreLink {
 public:
  // `went_on`: as CarryOut takes it.
  CentreLink(CentreAddress centre, std::function<bool()> went_on)
      : centre_(std::move(centre)), went_on_(std::move(went_on)) {}

  // Whether to go on; to be called at least once a second, also by who is at something else meanwhile.
  [[nodiscard]] bool GoesOn() const { return went_on_(); }
  // Whether it is there and takes the token.
  [[nodiscard]] Status Greet() const;
  // The manifest of a session, and what of it is still missing then. `superseded_by`: here.
  [[nodiscard]] Result<formats::ForwardReceipt> SendManifest(const SessionId& session, std::string text,
                                                             const std::vector<SessionId>& superseded_by = {}) const;
  struct BlobFile {
    Digest digest;
    std::filesystem::path file;
    std::int64_t size_bytes = 0;
  };
  // Files that the session's manifest names.
  [[nodiscard]] Status SendBlobs(const SessionId& session, const std::vector<BlobFile>& blobs) const;
  [[nodiscard]] Result<formats::ForwardReceipt> SendEdges(const BatchId& batch, const formats::EdgeSlice& slice) const;

  // Whether the centre has all of it, as it confirmed once; true where it does not tell, as the token is not of it.
  [[nodiscard]] Result<bool> HasSession(const SessionId& session) const;
  [[nodiscard]] Result<bool> HasBatch(const BatchId& batch) const;

  // What is in use there of these robots, of those that the token is of and of which something is; what is rejected.
  [[nodiscard]] Result<formats::WordsAtCentre> AskInUse(const std::vector<RobotId>& robots) const;

 private:
  [[nodiscard]] Status Ask(std::vector<Transfer>& transfers) const;
  [[nodiscard]] Result<bool> Has(const std::string& subject) const;

  static constexpr std::size_t kAtOnce = 16;
  const CentreAddress centre_;
  const std::function<bool()> went_on_;
  mutable std::size_t at_once_ = kAtOnce;  // fewer after requests that failed
};

}  // namespace rigcal::sites
