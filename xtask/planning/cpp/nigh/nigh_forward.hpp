// The part of nigh's interface that VAMP's RRT-Connect uses, by our own hand: nigh itself is in no package registry.
// The answers are the same (the exact nearest neighbour), and so are VAMP's trees; xtask/planning/README.md says how much
// time differs.
#pragma once

#include <cstddef>

namespace unc::robotics::nigh {

struct NoThreadSafety {};

template <std::size_t batch>
struct KDTreeBatch {};

template <class Value, class Space, class Key, class Concurrency, class Strategy>
class Nigh;

}  // namespace unc::robotics::nigh
