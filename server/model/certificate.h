// What a certificate says, in words and figures that are ready to be read: the page and the PDF only lay it out.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/diagnosis.h"

namespace rigcal {

struct CertificateCell {
  std::string text;
  int span = 1;  // columns that it takes
  friend bool operator==(const CertificateCell&, const CertificateCell&) = default;
};

struct CertificateTable {
  struct Column {
    std::string title;  // with its unit
    bool is_number = false;
    friend bool operator==(const Column&, const Column&) = default;
  };
  std::vector<Column> columns = {};
  std::vector<std::vector<CertificateCell>> rows = {};  // spans of a row make up all columns
  friend bool operator==(const CertificateTable&, const CertificateTable&) = default;
};

struct CertificatePart {
  std::string heading;
  std::vector<std::string> text = {};   // above the table, a paragraph each
  CertificateTable table = {};          // without columns: there is none
  std::vector<std::string> notes = {};  // below the table
  friend bool operator==(const CertificatePart&, const CertificatePart&) = default;
};

struct Certificate {
  RobotId robot;
  int revision = 0;
  std::string rig_model = {};  // empty: nobody named one
  std::string title;           // "Calibration certificate"; of what must not be relied on "..., no certificate"
  bool to_sign = false;        // it is in use, passed or warned, and is not overdue: else there is no place to sign
  std::string measured;        // when it was, and when it was solved
  std::string state;           // "In use: approved by Ada, 3 Nov 2026: checked."
  std::string rule;            // what it means for who drives
  Verdict verdict;             // its words cut to whole sentences that fit
  std::vector<CertificatePart> parts = {};
};

}  // namespace rigcal
