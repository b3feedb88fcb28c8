// How long VAMP takes to say that a state is free.
//
// usage: vamp_states WORKLOAD
// The workload has lines `sphere`, `cuboid` (as for vamp_plan), `edge` with two states, and `state`, and a name `obstacles N`.
// Edges and states that VAMP's spheres do not find free are left out, so that every test has to be carried to its end.
// Printed: `{lib, obstacles, ns_per_state_edge, ns_per_state_single, edges, states}`.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "vamp_scene.hpp"

using Edge = std::pair<Robot::Configuration, Robot::Configuration>;

struct Workload {
  int obstacles = 0;
  Scene scene;
  std::vector<Edge> edges;
  std::vector<Robot::Configuration> states;
};

static Workload read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  Workload workload;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    const auto x = numbers(words);
    if (kind == "obstacles") {
      workload.obstacles = int(x.at(0));
    } else if (kind == "edge") {
      workload.edges.push_back({configuration({x.begin(), x.begin() + 7}), configuration({x.begin() + 7, x.end()})});
    } else if (kind == "state") {
      workload.states.push_back(configuration(x));
    } else {
      add(workload.scene, kind, x);
    }
  }
  workload.scene.sort();
  return workload;
}

static bool free_along(const Edge& edge, const WideScene& scene) {
  return vamp::planning::validate_motion<Robot, rake, Robot::resolution>(edge.first, edge.second, scene);
}

static bool free_at(const Robot::Configuration& q, const WideScene& scene) {
  return vamp::planning::validate_motion<Robot, rake, 1>(q, q, scene);
}

// Of this thread's processor time.
static double processor_ns() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e9 + double(t.tv_nsec);
}

// Nanoseconds of one pass: the median of five rounds of at least a tenth of a second each.
template <class Pass>
static double time_of(Pass pass) {
  std::vector<double> rounds;
  for (int round = 0; round < 5; ++round) {
    std::size_t passes = 0;
    const double start = processor_ns();
    double spent = 0;
    for (; spent < 1e8; ++passes) {
      pass();
      spent = processor_ns() - start;
    }
    rounds.push_back(spent / double(passes));
  }
  std::sort(rounds.begin(), rounds.end());
  return rounds[2];
}

int main(int count, char** words) {
  if (count != 2) {
    std::cerr << "usage: vamp_states WORKLOAD\n";
    return 2;
  }
  auto workload = read(words[1]);
  const WideScene scene(workload.scene);
  auto& edges = workload.edges;
  auto& states = workload.states;
  edges.erase(std::remove_if(edges.begin(), edges.end(), [&](const Edge& e) { return !free_along(e, scene); }), edges.end());
  states.erase(std::remove_if(states.begin(), states.end(), [&](const auto& q) { return !free_at(q, scene); }), states.end());
  double along = 0;
  for (const auto& edge : edges) along += std::ceil(Robot::resolution * (edge.second - edge.first).l2_norm());
  volatile std::size_t found = 0;
  const double edge_ns = time_of([&] {
    for (const auto& edge : edges) found = found + free_along(edge, scene);
  });
  const double state_ns = time_of([&] {
    for (const auto& q : states) found = found + free_at(q, scene);
  });
  std::printf(
    "{\"lib\":\"vamp\",\"obstacles\":%d,\"ns_per_state_edge\":%.2f,\"ns_per_state_single\":%.2f,\"edges\":%zu,\"states\":%zu}\n",
    workload.obstacles, edge_ns / along, state_ns / double(states.size()), edges.size(), states.size());
}
