// The two kinds of Cholesky factor that MakeCholesky chooses from.
#pragma once

#include "server/graph/block_matrix.h"

namespace rigcal::graph {

template <int B>
[[nodiscard]] std::unique_ptr<BlockCholesky<B>> MakeDenseCholesky(const BlockPattern& pattern);
template <int B>
[[nodiscard]] std::unique_ptr<BlockCholesky<B>> MakeSparseCholesky(const BlockPattern& pattern);

}  // namespace rigcal::graph
