// The metric that VAMP names, and the template that it specialises.
#pragma once

namespace unc::robotics::nigh::metric {

template <int p>
struct LP {};

template <class Point, class Metric>
struct Space;

}  // namespace unc::robotics::nigh::metric
