#include "server/formats/json/json_writer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace rigcal::formats {
namespace {

using nlohmann::json;

// nlohmann's own dump is not always the shortest text (Grisu2), and a canonical form must not depend on a library's
// version: this is the text of Python's repr.
void AppendNumber(double value, std::string& out) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  const double magnitude = std::abs(value);
  const bool plain = magnitude == 0.0 || (magnitude >= 1e-4 && magnitude < 1e16);
  std::array<char, 40> buffer{};
  const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), magnitude == 0.0 ? 0.0 : value,
                                     plain ? std::chars_format::fixed : std::chars_format::scientific);
  const std::string_view text(buffer.data(), static_cast<std::size_t>(written.ptr - buffer.data()));
  out += text;
  if (plain && text.find('.') == std::string_view::npos) out += ".0";
}

bool NeedsNoEscape(const std::string& text) {
  for (const char c : text)
    if (c < 0x20 || c > 0x7e || c == '"' || c == '\\') return false;
  return true;
}

void AppendText(const std::string& text, std::string& out) {
  if (NeedsNoEscape(text)) {
    out.append(1, '"').append(text).append(1, '"');
  } else {
    out += json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  }
}

void Append(const json& value, std::string& out);

void AppendList(const json& list, std::string& out) {
  out += '[';
  const char* separator = "";
  for (const json& item : list) {
    out += std::exchange(separator, ",");
    Append(item, out);
  }
  out += ']';
}

void AppendObject(const json& object, std::string& out) {
  out += '{';
  const char* separator = "";
  for (const auto& [key, value] : object.get_ref<const json::object_t&>()) {
    out += std::exchange(separator, ",");
    AppendText(key, out);
    out += ':';
    Append(value, out);
  }
  out += '}';
}

void Append(const json& value, std::string& out) {
  switch (value.type()) {
    case json::value_t::object:
      return AppendObject(value, out);
    case json::value_t::array:
      return AppendList(value, out);
    case json::value_t::string:
      return AppendText(value.get_ref<const std::string&>(), out);
    case json::value_t::number_float:
      return AppendNumber(value.get<double>(), out);
    default:
      out += value.dump();
  }
}

}  // namespace

struct JsonWriter::Impl {
  json root;
  std::vector<json*> open;
  std::string key;

  json* Add(json value) {
    if (open.empty()) {
      root = std::move(value);
      return &root;
    }
    json& parent = *open.back();
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    json& member = parent[key];
    member = std::move(value);
    return &member;
  }
};

JsonWriter::JsonWriter() : impl_(std::make_unique<Impl>()) {}
JsonWriter::~JsonWriter() = default;

void JsonWriter::Key(std::string_view key) { impl_->key = key; }
void JsonWriter::BeginObject() { impl_->open.push_back(impl_->Add(json::object())); }
void JsonWriter::BeginList() { impl_->open.push_back(impl_->Add(json::array())); }
void JsonWriter::End() { impl_->open.pop_back(); }
void JsonWriter::Number(double value) { impl_->Add(value); }
void JsonWriter::Integer(std::int64_t value) { impl_->Add(value); }
void JsonWriter::Text(std::string_view value) { impl_->Add(std::string(value)); }
void JsonWriter::Flag(bool value) { impl_->Add(value); }
void JsonWriter::Null() { impl_->Add(nullptr); }

std::string JsonWriter::Finish() const {
  std::string out;
  Append(impl_->root, out);
  return out;
}

}  // namespace rigcal::formats
