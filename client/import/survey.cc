#include "client/import/survey.h"

#include <map>
#include <utility>

#include "client/bags/open_bag.h"
#include "client/import/topic_tally.h"

namespace rigcal::importing {
namespace {

constexpr std::int64_t kProgressEvery = 256;  // messages

}  // namespace

Result<BagSurvey> SurveyBag(const std::filesystem::path& path,
                            const std::function<void(std::int64_t, std::int64_t)>& progress) {
  RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(path));
  std::map<std::pair<std::string, std::string>, TopicTally> tallies;
  BagSurvey survey;
  bags::Message message;
  while (bag->Next(message)) {
    const auto key = std::pair(message.topic->name, message.topic->type);
    tallies.try_emplace(key, *message.topic).first->second.Add(message);
    survey.first_ns = survey.messages == 0 ? message.log_ns : std::min(survey.first_ns, message.log_ns);
    survey.last_ns = survey.messages == 0 ? message.log_ns : std::max(survey.last_ns, message.log_ns);
    if (++survey.messages % kProgressEvery == 0 && progress) progress(bag->bytes_done(), bag->bytes_total());
  }
  for (const auto& topic : bag->Topics()) tallies.try_emplace(std::pair(topic->name, topic->type), *topic);
  for (const auto& [key, tally] : tallies) survey.topics.push_back(tally.Found());
  survey.damage = bag->Unread().All();
  return survey;
}

}  // namespace rigcal::importing
