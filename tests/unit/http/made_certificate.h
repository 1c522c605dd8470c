// Certificates that are made for a test, and a client that speaks TLS.
#pragma once

#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "tests/unit/http/client.h"

namespace rigcal::http {

// `name`.pem and `name`.key in `folder`: of this name, signed by itself, good from a day ago for `days`.
struct MadeCertificate {
  std::filesystem::path certificate, key;
  MadeCertificate(const std::filesystem::path& folder, const std::string& name, int days = 2)
      : certificate(folder / (name + ".pem")), key(folder / (name + ".key")) {
    EVP_PKEY* pair = EVP_EC_gen("P-256");
    X509* made = X509_new();
    ASN1_INTEGER_set(X509_get_serialNumber(made), 1);
    X509_gmtime_adj(X509_getm_notBefore(made), -86'400);
    X509_gmtime_adj(X509_getm_notAfter(made), 86'400L * (days - 1));
    X509_set_pubkey(made, pair);
    const auto* text = reinterpret_cast<const unsigned char*>(name.c_str());
    X509_NAME_add_entry_by_txt(X509_get_subject_name(made), "CN", MBSTRING_ASC, text, -1, -1, 0);
    X509_set_issuer_name(made, X509_get_subject_name(made));
    EXPECT_GT(X509_sign(made, pair, EVP_sha256()), 0);
    Write(certificate, [&](std::FILE* file) { return PEM_write_X509(file, made); });
    Write(key,
          [&](std::FILE* file) { return PEM_write_PrivateKey(file, pair, nullptr, nullptr, 0, nullptr, nullptr); });
    X509_free(made);
    EVP_PKEY_free(pair);
  }

 private:
  template <typename Writer>
  static void Write(const std::filesystem::path& path, const Writer& writer) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    ASSERT_NE(file, nullptr);
    EXPECT_EQ(writer(file), 1);
    std::fclose(file);
  }
};

// What one question over TLS came to: whose certificate was seen, what was spoken, what was answered. Nothing is spoken
// where there was no handshake.
struct SecureReply {
  std::string name, version, cipher;
  Reply reply;
};

inline SecureReply AskSecurely(int port, const std::string& request, int version_max = 0) {
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
  SSL_CTX_set_max_proto_version(context.get(), version_max);
  SSL_CTX_set_security_level(context.get(), 0);
  const std::unique_ptr<BIO, decltype(&BIO_free_all)> bio(BIO_new_ssl_connect(context.get()), BIO_free_all);
  BIO_set_conn_hostname(bio.get(), ("127.0.0.1:" + std::to_string(port)).c_str());
  SecureReply got;
  if (BIO_do_handshake(bio.get()) != 1) return got;
  SSL* ssl = nullptr;
  BIO_get_ssl(bio.get(), &ssl);
  got.version = SSL_get_version(ssl);
  got.cipher = SSL_get_cipher(ssl);
  char name[64] = {};
  X509_NAME_get_text_by_NID(X509_get_subject_name(SSL_get0_peer_certificate(ssl)), NID_commonName, name, sizeof name);
  got.name = name;
  BIO_write(bio.get(), request.data(), static_cast<int>(request.size()));
  std::string text;
  std::array<char, 65536> buffer{};
  for (int count = 0; (count = BIO_read(bio.get(), buffer.data(), static_cast<int>(buffer.size()))) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(count));
  got.reply = Parsed(text);
  return got;
}
inline SecureReply GetSecurely(int port, const std::string& target, const std::string& headers = "",
                               int version_max = 0) {
  return AskSecurely(port, "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n", version_max);
}

}  // namespace rigcal::http
