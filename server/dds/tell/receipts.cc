#include "server/dds/tell/receipts.h"

#include "server/metrics/noted.h"

namespace rigcal::dds {

std::string NameOf(wire::ReceiptState state) {
  switch (state) {
    case wire::ReceiptState::kNeedManifest:
      return "need_manifest";
    case wire::ReceiptState::kReceiving:
      return "receiving";
    case wire::ReceiptState::kClosed:
      return "closed";
    case wire::ReceiptState::kRefused:
      return "refused";
  }
  return "refused";
}

void LogRefusal(LogSubject subject, const std::string& said, const Error& error) {
  metrics::NoteRefusal(error.code);
  subject.event = "refusal";
  subject.kind = rigcal::NameOf(error.code);
  Log(LogLevel::kWarn, subject, said + Sentence(error));
}

void LogReceipt(LogSubject subject, wire::ReceiptState state, const std::string& text) {
  subject.event = "receipt";
  Log(state == wire::ReceiptState::kClosed ? LogLevel::kInfo : LogLevel::kDebug, subject, text);
}

wire::Receipt RefusalReceipt(const RobotId& robot, std::string subject_id, std::uint64_t incarnation,
                             const Error& error) {
  wire::Receipt receipt;
  receipt.robot = robot;
  receipt.subject_id = std::move(subject_id);
  receipt.state = wire::ReceiptState::kRefused;
  receipt.incarnation = incarnation;
  receipt.error = ToldToClient(error);
  return receipt;
}

}  // namespace rigcal::dds
