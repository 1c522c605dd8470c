// Calendars are read by a reader of the test's own, by the grammar of RFC 5545: lines, unfolding, properties, escapes.
#include "server/formats/alerts/calendar.h"

#include <gmock/gmock.h>

#include <map>
#include <sstream>

namespace rigcal::formats {
namespace {

using Properties = std::map<std::string, std::string>;

// Content lines; each ends with CR LF and has at most 75 octets before it is put together.
std::vector<std::string> Unfolded(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find("\r\n", at);
    if (end == std::string::npos) {
      ADD_FAILURE() << "a line without its end";
      break;
    }
    EXPECT_LE(end - at, 75u);
    const std::string line = text.substr(at, end - at);
    EXPECT_EQ(line.find_first_of("\r\n"), std::string::npos);
    if (!line.empty() && line[0] == ' ')
      lines.back() += line.substr(1);
    else
      lines.push_back(line);
    at = end + 2;
  }
  return lines;
}

std::string Unescaped(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_TRUE(text[i] != ';' && text[i] != ',') << "not escaped: " << text;
    if (text[i] == '\\') ++i;
    plain += text[i] == 'n' && text[i - 1] == '\\' ? '\n' : text[i];
  }
  return plain;
}

std::vector<Properties> EventsOf(const std::string& text) {
  std::vector<Properties> events;
  bool inside = false;
  for (const std::string& line : Unfolded(text)) {
    const std::size_t colon = line.find(':');
    const std::string name = line.substr(0, colon), value = line.substr(colon + 1);
    if (line == "BEGIN:VEVENT") {
      events.emplace_back(), inside = true;
    } else if (line == "END:VEVENT") {
      inside = false;
    } else if (inside) {
      const bool is_time = name.rfind("DT", 0) == 0;
      EXPECT_TRUE(events.back().emplace(name, is_time ? value : Unescaped(value)).second) << name;
    }
  }
  EXPECT_FALSE(inside);
  return events;
}

CalendarEntry Entry() {
  return {"mapper-01.calibration@rigcal",
          ParseIso("2027-02-28T23:00:00Z").value(),
          ParseIso("2026-11-30T08:05:09Z").value(),
          4,
          "Calibrate mapper-01",
          "due 28 Feb 2027 by age",
          "hall 3"};
}

TEST(Calendar, IsReadBackAsItWasWritten) {
  CalendarEntry odd = Entry();
  odd.uid = "b";
  odd.description = "a; b, c \\ d\nsecond line, \xC3\xA4\xC3\xB6\xC3\xBC: " + std::string(200, 'x');
  odd.location = "";
  const std::string text = WriteCalendar("Calibrations due", {Entry(), odd});
  const auto lines = Unfolded(text);
  EXPECT_EQ(lines.front(), "BEGIN:VCALENDAR");
  EXPECT_EQ(lines[1], "VERSION:2.0");
  EXPECT_EQ(lines.back(), "END:VCALENDAR");
  const auto events = EventsOf(text);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].at("UID"), "mapper-01.calibration@rigcal");
  EXPECT_EQ(events[0].at("DTSTART;VALUE=DATE"), "20270228");
  EXPECT_EQ(events[0].at("DTEND;VALUE=DATE"), "20270301");
  EXPECT_EQ(events[0].at("DTSTAMP"), "20261130T080509Z");
  EXPECT_EQ(events[0].at("SEQUENCE"), "4");
  EXPECT_EQ(events[0].at("LOCATION"), "hall 3");
  EXPECT_EQ(events[1].at("DESCRIPTION"), odd.description);
  EXPECT_FALSE(events[1].contains("LOCATION"));
  EXPECT_EQ(WriteCalendar("Calibrations due", {Entry(), odd}), text) << "the same bytes";
}

TEST(Calendar, FoldsBetweenCharacters) {
  CalendarEntry entry = Entry();
  for (int ascii = 0; ascii < 4; ++ascii) {
    entry.summary = std::string(static_cast<std::size_t>(ascii), 'x');
    for (int i = 0; i < 60; ++i) entry.summary += "\xE2\x82\xAC";
    std::istringstream lines(WriteCalendar("c", {entry}));
    for (std::string line; std::getline(lines, line);)
      if (line.size() > 1) {
        EXPECT_NE(static_cast<unsigned char>(line[1]) & 0xC0, 0x80) << "a character was cut";
      }
    EXPECT_EQ(EventsOf(WriteCalendar("c", {entry}))[0].at("SUMMARY"), entry.summary);
  }
}

TEST(Calendar, TakesNoLineFromText) {
  CalendarEntry entry = Entry();
  entry.location = "x\r\nATTACH:http://evil\x01\xFF";
  const auto events = EventsOf(WriteCalendar("c", {entry}));
  EXPECT_FALSE(events[0].contains("ATTACH"));
  EXPECT_EQ(events[0].at("LOCATION"), "x?\nATTACH:http://evil??");
}

TEST(Calendar, OfNothingIsEmpty) { EXPECT_TRUE(EventsOf(WriteCalendar("c", {})).empty()); }

}  // namespace
}  // namespace rigcal::formats
