// Problems for VAMP's planners, read from a file, and paths printed.
//
// A problem is `problem SET ID`, `start q…`, `goal q…`, solids (`sphere`, `capsule`, `cuboid` and numbers), `end`.
#pragma once
#include "vamp_scene.hpp"

#include <vamp/planning/plan.hh>
#include <vamp/random/halton.hh>

using Path = vamp::planning::Path<Robot>;

struct Problem {
  std::string set, id;
  Robot::Configuration start, goal;
  Scene scene;
};

inline std::vector<Problem> read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  std::vector<Problem> problems;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "problem") {
      auto& problem = problems.emplace_back();
      words >> problem.set >> problem.id;
    } else if (kind == "start") {
      problems.back().start = configuration(numbers(words));
    } else if (kind == "goal") {
      problems.back().goal = configuration(numbers(words));
    } else if (kind == "end") {
      problems.back().scene.sort();
    } else {
      add(problems.back().scene, kind, numbers(words));
    }
  }
  return problems;
}

inline bool free_at(const Robot::Configuration& q, const WideScene& scene) {
  return vamp::planning::validate_motion<Robot, rake, 1>(q, q, scene);
}

inline bool is_valid(const Problem& problem) {
  const WideScene scene(problem.scene);
  return free_at(problem.start, scene) && free_at(problem.goal, scene);
}

inline double length(const Path& path) { return path.size() < 2 ? 0 : path.cost(); }

inline void print(const Path& path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto q = path[i].to_array();
    std::printf("%s[", i == 0 ? "" : ",");
    for (std::size_t k = 0; k < Robot::dimension; ++k) std::printf("%s%.9g", k == 0 ? "" : ",", double(q[k]));
    std::printf("]");
  }
}
