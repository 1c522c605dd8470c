#include "server/formats/alerts/webhook_answers.h"

#include "server/formats/json/json_values.h"

namespace rigcal::formats {

std::string WriteWebhooks(const std::vector<ReceiverState>& receivers, Stamp now) {
  return WriteObject([&](JsonWriter& out) {
    WriteStamp(out, "now", now);
    out.List("webhooks", [&] {
      for (const ReceiverState& one : receivers)
        out.Object([&] {
          out.Text("url", one.url);
          out.Flag("configured", one.is_told);
          out.Integer("waiting", one.waiting);
          out.Integer("delivered", one.delivered);
          WriteStamp(out, "oldest_at", one.oldest_at);
          out.Integer("attempts", one.attempts);
          WriteStamp(out, "next_try_at", one.next_try_at);
          one.last_error.empty() ? out.Null("last_error") : out.Text("last_error", one.last_error);
        });
    });
  });
}

std::string WriteDueCalendar(std::string_view calendar, std::int64_t without_date) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("ics", calendar);
    out.Integer("without_date", without_date);
  });
}

}  // namespace rigcal::formats
