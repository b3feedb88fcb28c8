// A k-d tree whose leaves hold up to `batch` values and split at the middle of their longest side.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "nigh_forward.hpp"

namespace unc::robotics::nigh {

template <class Value, class Space, class Key, class Concurrency, std::size_t batch>
class Nigh<Value, Space, Key, Concurrency, KDTreeBatch<batch>> {
  using Point = typename Space::Type;
  using Distance = typename Space::Distance;
  static constexpr int dimensions = Space::kDimensions;
  static constexpr Distance far = 1e9;  // VAMP is compiled without infinity

  struct Node {
    std::vector<Value> values;  // of a leaf
    std::array<Distance, dimensions> low, high;
    int axis = -1;  // -1: a leaf
    Distance split = 0;
    std::unique_ptr<Node> below, above;

    Node() {
      values.reserve(batch);
      low.fill(far);
      high.fill(-far);
    }
  };

  struct Search {
    const Point& query;
    const Value* best = nullptr;
    Distance distance = far;
  };

  std::unique_ptr<Node> root_ = std::make_unique<Node>();
  std::size_t size_ = 0;

 public:
  std::size_t size() const { return size_; }

  void insert(const Value& value) {
    const Point& point = Key()(value);
    Node* node = root_.get();
    widen(*node, point);
    while (node->axis >= 0) {
      node = (Space::coeff(point, node->axis) < node->split ? node->below : node->above).get();
      widen(*node, point);
    }
    if (node->values.size() == batch && divide(*node)) {
      node = (Space::coeff(point, node->axis) < node->split ? node->below : node->above).get();
      widen(*node, point);
    }
    node->values.push_back(value);
    ++size_;
  }

  std::optional<std::pair<Value, Distance>> nearest(const Point& query) const {
    Search search{query};
    std::array<Distance, dimensions> gaps;
    Distance sum = 0;
    for (int k = 0; k < dimensions; ++k) sum += gaps[k] = gap(*root_, query, k);
    if (size_ > 0) visit(*root_, search, gaps, sum);
    if (search.best == nullptr) return std::nullopt;
    return std::pair{*search.best, search.distance};
  }

 private:
  static void widen(Node& node, const Point& point) {
    for (int k = 0; k < dimensions; ++k) {
      const Distance x = Space::coeff(point, k);
      node.low[k] = std::min(node.low[k], x);
      node.high[k] = std::max(node.high[k], x);
    }
  }

  // False where all values are one point.
  static bool divide(Node& node) {
    int axis = 0;
    for (int k = 1; k < dimensions; ++k) {
      if (node.high[k] - node.low[k] > node.high[axis] - node.low[axis]) axis = k;
    }
    const Distance split = node.low[axis] + (node.high[axis] - node.low[axis]) / 2;
    if (!(node.low[axis] < split)) return false;
    node.axis = axis;
    node.split = split;
    node.below = std::make_unique<Node>();
    node.above = std::make_unique<Node>();
    for (const Value& value : node.values) {
      Node& side = *(Space::coeff(Key()(value), axis) < split ? node.below : node.above);
      widen(side, Key()(value));
      side.values.push_back(value);
    }
    node.values = {};
    return true;
  }

  // How far the query is outside the node's box along an axis, squared.
  static Distance gap(const Node& node, const Point& query, int axis) {
    const Distance x = Space::coeff(query, axis);
    const Distance outside = std::max({Distance(0), node.low[axis] - x, x - node.high[axis]});
    return outside * outside;
  }

  // `gaps` and their `sum` bound the squared distance from below; the side of the query comes first.
  static void visit(const Node& node, Search& search, std::array<Distance, dimensions>& gaps, Distance sum) {
    if (node.axis < 0) {
      for (const Value& value : node.values) {
        const Distance distance = Space::distance(Key()(value), search.query);
        if (distance < search.distance) {
          search.distance = distance;
          search.best = &value;
        }
      }
      return;
    }
    const bool below = Space::coeff(search.query, node.axis) < node.split;
    for (const Node* side : {(below ? node.below : node.above).get(), (below ? node.above : node.below).get()}) {
      const Distance old = gaps[node.axis], fresh = gap(*side, search.query, node.axis);
      const Distance bound = sum - old + fresh;
      if (bound > search.distance * search.distance) continue;
      gaps[node.axis] = fresh;
      visit(*side, search, gaps, bound);
      gaps[node.axis] = old;
    }
  }
};

}  // namespace unc::robotics::nigh
