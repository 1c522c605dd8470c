#include "idl/ros/cdr_type.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

namespace rigcal::wire::internal {
namespace {

constexpr std::size_t kWord_bytes = 4;  // the wire is filled up to whole words

struct CdrSample : ddsi_serdata {
  CdrSample(const ddsi_sertype* of_type, ddsi_serdata_kind of_kind, std::size_t bytes)
      : ddsi_serdata{}, size(bytes), data((bytes + kWord_bytes - 1) / kWord_bytes * kWord_bytes) {
    ddsi_serdata_init(this, of_type, of_kind);
    hash = of_type->serdata_basehash;
  }
  std::size_t size;
  std::vector<std::byte> data;  // whole words, zero behind `size`
  std::int64_t sequence = 0;
};

CdrSample& Own(ddsi_serdata* sample) { return *static_cast<CdrSample*>(sample); }
const CdrSample& Own(const ddsi_serdata* sample) { return *static_cast<const CdrSample*>(sample); }

// Called from C: what cannot be allocated is null there.
CdrSample* NewSample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) noexcept {
  try {
    return new CdrSample(type, kind, size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

// Without keys all samples are of one instance.
bool HasSameKey(const ddsi_serdata*, const ddsi_serdata*) { return true; }

std::uint32_t SizeOfSample(const ddsi_serdata* sample) { return static_cast<std::uint32_t>(Own(sample).size); }

// The number that the writer gave it, as it stands in the datagram: DDS does not tell readers of gaps in it. 0 where
// the datagram is of another kind than Data and DataFrag (DDSI-RTPS 2.5, 9.4.5.4 and 9.4.5.5, which begin alike).
std::int64_t SequenceIn(const nn_rdata& fragment) {
  constexpr unsigned char kData = 0x15, kDataFrag = 0x16;
  constexpr std::size_t kSequenceAt_bytes = 16;
  const std::size_t at = NN_RDATA_SUBMSG_OFF(&fragment);
  const unsigned char* submessage = NN_RMSG_PAYLOADOFF(fragment.rmsg, at);
  if (at == 0 || (submessage[0] != kData && submessage[0] != kDataFrag)) return 0;
  std::int32_t high = 0;
  std::uint32_t low = 0;
  std::memcpy(&high, submessage + kSequenceAt_bytes, sizeof high);
  std::memcpy(&low, submessage + kSequenceAt_bytes + sizeof high, sizeof low);
  return (std::int64_t{high} << 32) + low;
}

// Fragments may overlap.
ddsi_serdata* OfFragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                          std::size_t size) {
  CdrSample* sample = NewSample(type, kind, size);
  if (sample != nullptr && fragment != nullptr) sample->sequence = SequenceIn(*fragment);
  for (; sample != nullptr && fragment != nullptr; fragment = fragment->nextfrag) {
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    if (fragment->min < end) std::memcpy(sample->data.data() + fragment->min, payload, end - fragment->min);
  }
  return sample;
}

ddsi_serdata* OfPieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                       const ddsrt_iovec_t* pieces, std::size_t size) {
  CdrSample* sample = NewSample(type, kind, size);
  std::size_t at = 0;
  for (ddsrt_msg_iovlen_t i = 0; sample != nullptr && i < count && at < size; ++i) {
    const std::size_t bytes = std::min<std::size_t>(pieces[i].iov_len, size - at);
    std::memcpy(sample->data.data() + at, pieces[i].iov_base, bytes);
    at += bytes;
  }
  return sample;
}

ddsi_serdata* OfKeyHash(const ddsi_sertype* type, const ddsi_keyhash*) { return NewSample(type, SDK_KEY, 0); }

// Samples are bytes already: there is no other form to make one of, or one to make.
ddsi_serdata* OfSample(const ddsi_sertype*, ddsi_serdata_kind, const void*) { return nullptr; }
bool FillSample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool FillKey(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return false; }

void CopyBytes(const ddsi_serdata* sample, std::size_t at, std::size_t size, void* to) {
  std::memcpy(to, Own(sample).data.data() + at, size);
}

ddsi_serdata* BorrowBytes(const ddsi_serdata* sample, std::size_t at, std::size_t size, ddsrt_iovec_t* borrowed) {
  borrowed->iov_base = const_cast<std::byte*>(Own(sample).data.data() + at);
  borrowed->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(sample);
}
void ReturnBytes(ddsi_serdata* sample, const ddsrt_iovec_t*) { ddsi_serdata_unref(sample); }

ddsi_serdata* KeyOf(const ddsi_serdata* sample) {
  CdrSample* key = NewSample(sample->type, SDK_KEY, 0);
  if (key != nullptr) key->type = nullptr;
  return key;
}

void FreeSample(ddsi_serdata* sample) { delete &Own(sample); }

std::size_t PrintSample(const ddsi_sertype* type, const ddsi_serdata* sample, char* to, std::size_t size) {
  const int written =
      std::snprintf(to, size, "%s of %zu bytes", type == nullptr ? "sample" : type->type_name, Own(sample).size);
  return written < 0 ? 0 : static_cast<std::size_t>(written);
}

void SetKeyHash(const ddsi_serdata*, ddsi_keyhash* hash, bool) { *hash = {}; }

constexpr ddsi_serdata_ops SampleOperations() {
  ddsi_serdata_ops ops{};
  ops.eqkey = HasSameKey;
  ops.get_size = SizeOfSample;
  ops.from_ser = OfFragments;
  ops.from_ser_iov = OfPieces;
  ops.from_keyhash = OfKeyHash;
  ops.from_sample = OfSample;
  ops.to_ser = CopyBytes;
  ops.to_ser_ref = BorrowBytes;
  ops.to_ser_unref = ReturnBytes;
  ops.to_sample = FillSample;
  ops.to_untyped = KeyOf;
  ops.untyped_to_sample = FillKey;
  ops.free = FreeSample;
  ops.print = PrintSample;
  ops.get_keyhash = SetKeyHash;
  return ops;
}
constexpr ddsi_serdata_ops kSampleOperations = SampleOperations();

void FreeType(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
void ZeroSamples(const ddsi_sertype*, void*, std::size_t) {}
void ReallocSamples(void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  std::fill_n(samples, count, nullptr);
}
void FreeSamples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
bool IsSameType(const ddsi_sertype*, const ddsi_sertype*) { return true; }  // whose names are the same
std::uint32_t HashOfType(const ddsi_sertype*) { return 0; }

const ddsi_sertype_ops& TypeOperations() {
  static const ddsi_sertype_ops operations = [] {
    ddsi_sertype_ops ops{};
    ops.version = ddsi_sertype_v0;
    ops.free = FreeType;
    ops.zero_samples = ZeroSamples;
    ops.realloc_samples = ReallocSamples;
    ops.free_samples = FreeSamples;
    ops.equal = IsSameType;
    ops.hash = HashOfType;
    return ops;
  }();
  return operations;
}

}  // namespace

ddsi_sertype* NewCdrType(const std::string& type_name) {
  auto type = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init_flags(type.get(), type_name.c_str(), &TypeOperations(), &kSampleOperations,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type.release();
}

ddsi_serdata* NewCdrSample(const ddsi_sertype* type, std::span<const std::byte> bytes) noexcept {
  CdrSample* sample = NewSample(type, SDK_DATA, bytes.size());
  if (sample != nullptr) std::copy(bytes.begin(), bytes.end(), sample->data.begin());
  return sample;
}

std::span<const std::byte> CdrBytesOf(const ddsi_serdata* sample) {
  return {Own(sample).data.data(), Own(sample).size};
}

std::int64_t SequenceOf(const ddsi_serdata* sample) { return Own(sample).sequence; }

}  // namespace rigcal::wire::internal
