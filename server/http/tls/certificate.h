// What this server shows of itself over TLS: a certificate with its chain, and the key of it (OpenSSL).
#pragma once

#include <filesystem>
#include <memory>

#include "server/base/result.h"

namespace rigcal::http {

// TLS 1.2 and 1.3, ciphers with forward secrecy and authentication only. Any thread.
class Certificate {
 public:
  // PEM files: the server's certificate first, then those that vouch for it; its key without a pass phrase.
  // kInvalidInput names the file that cannot be read or holds something else, or says that the two do not belong
  // together. Of one that is out of date or not yet valid the log warns.
  [[nodiscard]] static Result<std::shared_ptr<Certificate>> Load(const std::filesystem::path& certificate,
                                                                 const std::filesystem::path& key);
  ~Certificate();
  Certificate(const Certificate&) = delete;
  Certificate& operator=(const Certificate&) = delete;

  // Reads both files again: connections from now on see what is in them. Where Load() would refuse them, the error; the
  // certificate stays as it was.
  [[nodiscard]] Status Reload();
  // OpenSSL's SSL_CTX: for connections of civetweb, as long as this lives.
  [[nodiscard]] void* context() const;

 private:
  struct Impl;
  explicit Certificate(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::http
