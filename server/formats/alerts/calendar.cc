#include "server/formats/alerts/calendar.h"

#include <algorithm>

#include "server/base/text.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kLineOctetsMax = 75;

bool IsContinuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// No control character goes out but for the line ends that are escaped.
std::string Cleaned(const std::string& text) {
  std::string without_ends = text;
  std::replace(without_ends.begin(), without_ends.end(), '\n', ' ');
  if (IsPrintableUtf8(without_ends)) return text;
  std::string cleaned = text;
  for (char& c : cleaned)
    if (c != '\n' && (c < ' ' || c > '~')) c = '?';
  return cleaned;
}

// TEXT of RFC 5545, 3.3.11.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : Cleaned(text)) {
    if (c == '\n') {
      escaped += "\\n";
      continue;
    }
    if (c == '\\' || c == ';' || c == ',') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

// A line that goes on begins with a space, which counts (3.1).
void AddLine(const std::string& line, std::string& out) {
  std::size_t octets = 0;
  for (std::size_t at = 0; at < line.size();) {
    std::size_t end = at + 1;
    while (end < line.size() && IsContinuation(line[end])) ++end;
    if (octets + (end - at) > kLineOctetsMax) {
      out += "\r\n ";
      octets = 1;
    }
    out.append(line, at, end - at);
    octets += end - at;
    at = end;
  }
  out += "\r\n";
}

std::string Digits(const std::string& iso) {
  std::string digits;
  for (const char c : iso)
    if (c >= '0' && c <= '9') digits += c;
  return digits;
}

// "20260131"
std::string DateOf(Stamp day) { return Digits(ToIso(day).substr(0, 10)); }

// "20260131T120000Z"
std::string TimeOf(Stamp at) { return DateOf(at) + "T" + Digits(ToIso(at).substr(11, 8)) + "Z"; }

void AddEntry(const CalendarEntry& entry, std::string& out) {
  constexpr std::int64_t kOneDay_ns = 86'400'000'000'000;
  AddLine("BEGIN:VEVENT", out);
  AddLine("UID:" + Escaped(entry.uid), out);
  AddLine("DTSTAMP:" + TimeOf(entry.known_at), out);
  AddLine("DTSTART;VALUE=DATE:" + DateOf(entry.day), out);
  AddLine("DTEND;VALUE=DATE:" + DateOf(Stamp{entry.day.ns + kOneDay_ns}), out);
  AddLine("SEQUENCE:" + std::to_string(entry.sequence), out);
  AddLine("SUMMARY:" + Escaped(entry.summary), out);
  AddLine("DESCRIPTION:" + Escaped(entry.description), out);
  if (!entry.location.empty()) AddLine("LOCATION:" + Escaped(entry.location), out);
  AddLine("TRANSP:TRANSPARENT", out);
  AddLine("END:VEVENT", out);
}

}  // namespace

std::string WriteCalendar(const std::string& name, const std::vector<CalendarEntry>& entries) {
  std::string out;
  AddLine("BEGIN:VCALENDAR", out);
  AddLine("VERSION:2.0", out);
  AddLine("PRODID:-//Rigcal//Calibrations due//EN", out);
  AddLine("CALSCALE:GREGORIAN", out);
  AddLine("METHOD:PUBLISH", out);
  AddLine("X-WR-CALNAME:" + Escaped(name), out);
  for (const CalendarEntry& entry : entries) AddEntry(entry, out);
  AddLine("END:VCALENDAR", out);
  return out;
}

}  // namespace rigcal::formats
