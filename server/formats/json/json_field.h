// Reads JSON that may be hostile: bounded in size and depth, no repeated keys, and every error names the field by its
// path ("edges[3].T_a_b.q_xyzw: must have unit length").
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/result.h"

namespace rigcal::formats {

constexpr std::size_t kJsonDepthMax = 32;
constexpr std::size_t kTextMax = 4096;  // bytes of one free text

struct JsonKind {
  std::string name;  // "manifest": starts every error
  std::string cure;  // what to do about a wrong document
  std::size_t bytes_max;
};

struct JsonTree;

// A place in a document. The first wrong field is remembered by the document; from then on values are empty, so that
// readers run straight through and ask the document's status() once, before the value is used. Lives as long as the
// JsonDocument.
class JsonField {
 public:
  // A member that must be there; it may be null.
  [[nodiscard]] JsonField At(std::string_view key) const;
  // A member that may be absent or null.
  [[nodiscard]] std::optional<JsonField> Find(std::string_view key) const;
  [[nodiscard]] std::vector<JsonField> Items(std::size_t count_max) const;
  [[nodiscard]] std::vector<std::pair<std::string, JsonField>> Members(std::size_t count_max) const;
  [[nodiscard]] bool IsNull() const;

  // One value of that kind, else the field is refused; an integer outside of min to max, and a longer text, too.
  [[nodiscard]] double Number() const;
  [[nodiscard]] std::int64_t Integer(std::int64_t min, std::int64_t max) const;
  [[nodiscard]] bool Flag() const;
  [[nodiscard]] std::string Text(std::size_t bytes_max = kTextMax) const;
  // Exactly `count` numbers.
  void Numbers(double* to, std::size_t count) const;

  // Refuses every other key by name.
  void AllowOnly(std::initializer_list<std::string_view> keys) const;
  // "<document>: <path>: <what>"; only the first one counts.
  void Refuse(const std::string& what) const;

 private:
  friend class JsonDocument;
  JsonField(JsonTree* tree, const void* node) : tree_(tree), node_(node) {}

  JsonTree* tree_;
  const void* node_;  // null: an error was found before
};

class JsonDocument {
 public:
  // kInvalidInput: larger than the kind allows, not JSON, nested deeper than kJsonDepthMax, or a key twice.
  [[nodiscard]] static Result<JsonDocument> Parse(std::string_view text, const JsonKind& kind);
  // A document that was moved from may only be assigned to or destroyed.
  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  ~JsonDocument();
  // Valid as long as the document, also after it was moved.
  [[nodiscard]] JsonField Root();
  // The first refusal; good where there was none.
  [[nodiscard]] Status status() const;

 private:
  explicit JsonDocument(std::unique_ptr<JsonTree> tree);
  std::unique_ptr<JsonTree> tree_;
};

}  // namespace rigcal::formats
