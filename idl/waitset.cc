#include <array>

#include "idl/dds.h"

namespace rigcal::wire {
namespace {

constexpr std::size_t kWokenMax = 64;

Status Attached(dds_return_t code) {
  if (code == DDS_RETCODE_OK) return {};
  return Fail(ErrorCode::kInternal, std::string("DDS wait set: ") + dds_strretcode(-code),
              "A fault in Rigcal or too little memory: report it with the log");
}

}  // namespace

WaitSet::WaitSet(Entity guard, Entity waitset) : guard_(std::move(guard)), waitset_(std::move(waitset)) {}

Result<WaitSet> WaitSet::Open(const Participant& participant) {
  WaitSet made(Entity(dds_create_guardcondition(participant.get())), Entity(dds_create_waitset(participant.get())));
  RIGCAL_TRY(Attached(dds_waitset_attach(made.waitset_.get(), made.guard_.get(), made.guard_.get())));
  return made;
}

// A read condition stays true while the reader holds samples, so a Take that leaves some is woken again; a match is an
// edge, cleared in Wait.
Status WaitSet::Attach(dds_entity_t reader_or_writer) {
  const dds_entity_t condition = dds_create_readcondition(reader_or_writer, DDS_ANY_STATE);
  if (condition > 0) {
    conditions_.emplace_back(condition);
    RIGCAL_TRY(Attached(dds_waitset_attach(waitset_.get(), condition, 0)));
  }
  return Attached(dds_waitset_attach(waitset_.get(), reader_or_writer, reader_or_writer));
}

Result<bool> WaitSet::Wait(std::chrono::milliseconds timeout) {
  std::array<dds_attach_t, kWokenMax> woken{};
  const dds_return_t count = dds_waitset_wait(waitset_.get(), woken.data(), woken.size(), DDS_MSECS(timeout.count()));
  if (count < 0) RIGCAL_TRY(Attached(count));
  const std::size_t listed = std::min(woken.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < listed; ++i) {
    const auto entity = static_cast<dds_entity_t>(woken[i]);
    bool was_set = false;
    if (entity == guard_.get()) dds_take_guardcondition(entity, &was_set);
    if (entity != guard_.get() && entity != 0) internal::ClearMatch(entity);
  }
  return count > 0;
}

void WaitSet::Wake() { dds_set_guardcondition(guard_.get(), true); }

}  // namespace rigcal::wire
