// A parsed JSON document, read tolerantly: what is absent or of another type is null, never an exception. Documents of
// a newer server may have more fields than this client knows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace rigcal::client {

constexpr int kDocumentDepthMax = 64;  // lists and objects within each other

class Document {
 public:
  Document();  // null
  // kUnsupported: not JSON, or nested deeper than kDocumentDepthMax. `origin` is named in the error.
  [[nodiscard]] static Result<Document> Parse(std::string_view text, std::string_view origin);

  [[nodiscard]] Document operator[](std::string_view key) const;  // member of an object, or null
  [[nodiscard]] Document operator[](std::size_t idx) const;       // element of an array, or null
  // Also of what is not there.
  [[nodiscard]] bool IsNull() const;
  [[nodiscard]] bool Has(std::string_view key) const;   // of an object: the member is there, be it null
  [[nodiscard]] std::size_t size() const;               // of an array or object; else 0
  [[nodiscard]] std::vector<Document> Items() const;    // elements of an array; else none
  [[nodiscard]] std::vector<std::string> Keys() const;  // of an object; else none
  // The value, if it is of that kind; else the fallback, or nothing.
  [[nodiscard]] std::string Text(std::string_view fallback = "") const;
  [[nodiscard]] std::optional<double> Number() const;
  [[nodiscard]] std::optional<std::int64_t> Integer() const;
  [[nodiscard]] bool Flag(bool fallback = false) const;
  [[nodiscard]] std::string Dump() const;  // compact JSON

 private:
  struct Node;
  explicit Document(std::shared_ptr<const Node> node);
  std::shared_ptr<const Node> node_;  // keeps the whole tree alive
};

// {"key": value, ...} as JSON text; for requests.
struct Field {
  // `text` is quoted and escaped.
  Field(std::string key, const std::string& text);
  Field(std::string key, const char* text);
  Field(std::string key, std::int64_t value);
  [[nodiscard]] static Field Raw(std::string key, std::string json);  // the value is JSON already
  std::string key, json;
};
// In the order of `fields`; keys are quoted, and not looked at for repeats.
[[nodiscard]] std::string JsonObject(const std::vector<Field>& fields);

}  // namespace rigcal::client
