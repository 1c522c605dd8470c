#include "server/graph/large/lane_kernels.h"

namespace rigcal::graph {
namespace {

constexpr double kFinite = __DBL_MAX__;

// The first of the files serves the other.
// clang-format off
namespace portable {
#include "server/graph/large/triangle_lanes.inc"
#include "server/graph/large/edge_lanes.inc"
}  // namespace portable

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx")
#endif
namespace avx {
#include "server/graph/large/triangle_lanes.inc"
#include "server/graph/large/edge_lanes.inc"
}  // namespace avx
// clang-format on
#ifdef __clang__
#  pragma clang attribute pop
#else
#  pragma GCC pop_options
#endif

constexpr LaneKernels kPortable{portable::Factor,    portable::Solve,  portable::InverseColumns, portable::Information,
                                portable::Residuals, portable::Forces, portable::Blocks};
constexpr LaneKernels kAvx{avx::Factor,    avx::Solve,  avx::InverseColumns, avx::Information,
                           avx::Residuals, avx::Forces, avx::Blocks};

}  // namespace

const LaneKernels& PortableKernels() { return kPortable; }

const LaneKernels& Kernels() {
  static const LaneKernels& kernels = __builtin_cpu_supports("avx") ? kAvx : kPortable;
  return kernels;
}

}  // namespace rigcal::graph
