// Builds one JSON document and writes it canonically (docs/api.md, rules): keys sorted, compact, shortest numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace rigcal::formats {

// Calls with a key are for objects, calls without for lists and for the root. Numbers that are not finite become null;
// text that is not UTF-8 gets U+FFFD in its place.
class JsonWriter {
 public:
  // An empty document: the first call sets its root.
  JsonWriter();
  ~JsonWriter();
  JsonWriter(const JsonWriter&) = delete;
  JsonWriter& operator=(const JsonWriter&) = delete;

  // `body` writes what is in it. Objects sort their members by key; of a key twice the last one counts.
  template <typename Body>
  void Object(const Body& body) {
    BeginObject();
    body();
    End();
  }
  template <typename Body>
  void Object(std::string_view key, const Body& body) {
    Key(key);
    Object(body);
  }
  // `body` writes its items, in their order.
  template <typename Body>
  void List(const Body& body) {
    BeginList();
    body();
    End();
  }
  template <typename Body>
  void List(std::string_view key, const Body& body) {
    Key(key);
    List(body);
  }

  // The shortest digits that read back as the same double.
  void Number(double value);
  void Number(std::string_view key, double value) {
    Key(key);
    Number(value);
  }
  // All digits, also beyond 2^53.
  void Integer(std::int64_t value);
  void Integer(std::string_view key, std::int64_t value) {
    Key(key);
    Integer(value);
  }
  // Escaped as JSON needs it.
  void Text(std::string_view value);
  void Text(std::string_view key, std::string_view value) {
    Key(key);
    Text(value);
  }
  // true or false.
  void Flag(bool value);
  void Flag(std::string_view key, bool value) {
    Key(key);
    Flag(value);
  }
  // What is absent.
  void Null();
  void Null(std::string_view key) {
    Key(key);
    Null();
  }

  // The whole text, in one line; all that was begun must have ended.
  [[nodiscard]] std::string Finish() const;

 private:
  void Key(std::string_view key);
  void BeginObject();
  void BeginList();
  void End();

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The document of an object: Body fills it.
template <typename Body>
[[nodiscard]] std::string WriteObject(const Body& body) {
  JsonWriter writer;
  writer.Object([&] { body(writer); });
  return writer.Finish();
}

}  // namespace rigcal::formats
