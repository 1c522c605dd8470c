#include "client/bags/ros1_records.h"

#include <span>

namespace rigcal::bags {

std::optional<Ros1Fields> Ros1Fields::Read(std::span<const std::byte> bytes) {
  Ros1Fields fields;
  Cursor in(bytes);
  while (!in.AtEnd()) {
    const std::string_view field = in.Text();
    const std::size_t equals = field.find('=');
    if (in.failed() || equals == std::string_view::npos) return std::nullopt;
    fields.fields_[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

std::string_view Ros1Fields::Text(std::string_view name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string_view() : found->second;
}

std::optional<std::uint32_t> Ros1Fields::Number(std::string_view name) const {
  const std::string_view text = Text(name);
  if (text.size() != 4) return std::nullopt;
  return Cursor(std::as_bytes(std::span(text))).Number<std::uint32_t>();
}

std::optional<std::int64_t> Ros1Fields::Time_ns(std::string_view name) const {
  const std::string_view text = Text(name);
  if (text.size() != 8) return std::nullopt;
  Cursor in(std::as_bytes(std::span(text)));
  const auto seconds = in.Number<std::uint32_t>();
  return std::int64_t{seconds} * 1'000'000'000 + in.Number<std::uint32_t>();
}

std::optional<Ros1Op> Ros1Fields::op() const {
  const std::string_view text = Text("op");
  if (text.size() != 1) return std::nullopt;
  return static_cast<Ros1Op>(text[0]);
}

}  // namespace rigcal::bags
