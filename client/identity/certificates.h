// X.509 with OpenSSL: keys, the authority's certificate, certificates of identities, the list of revoked ones, and
// documents that the authority signs. Texts are PEM, or S/MIME. Errors are kInternal: OpenSSL has no memory or no
// randomness, or kInvalidInput: a text is not what it should be.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/base/identity/identity_folder.h"

namespace rigcal::client {

struct KeyAndCertificate {
  std::string key, certificate;  // PEM; the key has no pass phrase
};

// What an authority signs with. Moves only; the key is wiped from memory with it.
class Signer {
 public:
  // A new one, that vouches for itself until `not_after`, under a name that no other has: `of` says of what it is.
  [[nodiscard]] static Result<KeyAndCertificate> Make(const std::string& of, Stamp not_before, Stamp not_after);
  // Names `origin` where the two are no key and certificate that belong together.
  [[nodiscard]] static Result<Signer> Read(const KeyAndCertificate& texts, const std::string& origin);
  ~Signer();
  Signer(Signer&&) noexcept;
  Signer& operator=(Signer&&) noexcept;

  // A key of its own and a certificate for `identity`, with a new serial number, which is told in it.
  [[nodiscard]] Result<KeyAndCertificate> Vouch(const DdsIdentity& identity) const;
  // `text` with the signature below it, readable (S/MIME).
  [[nodiscard]] Result<std::string> Sign(const std::string& text) const;
  // The list of the certificates with these serial numbers (hex digits), as of `now` and good as long as the authority.
  [[nodiscard]] Result<std::string> ListRevoked(const std::vector<std::string>& serials, Stamp now) const;
  [[nodiscard]] Stamp not_after() const;

 private:
  struct Impl;
  explicit Signer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::client
