// VAMP's RRT-Connect and simplification on a file of problems, as its own scripts/evaluate_mbm.py runs them.
//
// usage: vamp_plan PROBLEMS ITERATIONS SKIP…
// Each SKIP is a pass over all problems whose Halton sequence starts that many states later.
// Printed: an attempt per line, as xtask/planning/README.md has it. Times are VAMP's own.
#include <chrono>
#include <iostream>

#include "vamp_problems.hpp"

#include <vamp/planning/rrtc.hh>
#include <vamp/planning/simplify.hh>

using RRTC = vamp::planning::RRTC<Robot, rake, Robot::resolution>;
using Clock = std::chrono::steady_clock;

static void attempt(const Problem& problem, std::size_t skip, std::size_t iterations) {
  const bool valid = is_valid(problem);
  vamp::planning::RRTCSettings settings;
  settings.range = 1.0;
  settings.max_iterations = settings.max_samples = iterations;
  auto rng = std::make_shared<vamp::rng::Halton<Robot>>();
  for (std::size_t i = 0; i < skip; ++i) rng->next();
  vamp::planning::PlanningResult<Robot> raw, simple;
  const auto start = Clock::now();
  if (valid) {
    raw = RRTC::solve(problem.start, problem.goal, WideScene(problem.scene), settings, rng);
    if (!raw.path.empty()) {
      const WideScene scene(problem.scene);
      simple = vamp::planning::simplify<Robot, rake, Robot::resolution>(raw.path, scene, {}, rng);
    }
  }
  const double call = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  std::printf(
    "{\"set\":\"%s\",\"id\":\"%s\",\"seed\":%zu,\"valid\":%s,\"solved\":%s,\"planning_us\":%.3f,\"simplify_us\":%.3f,"
    "\"call_us\":%.3f,\"iterations\":%zu,\"cost_raw\":%.6f,\"cost\":%.6f,\"path\":[",
    problem.set.c_str(), problem.id.c_str(), skip, valid ? "true" : "false", raw.path.empty() ? "false" : "true",
    double(raw.nanoseconds) / 1e3, double(simple.nanoseconds) / 1e3, call, raw.iterations, length(raw.path), length(simple.path));
  print(simple.path);
  std::printf("]}\n");
}

int main(int count, char** words) {
  if (count < 4) {
    std::cerr << "usage: vamp_plan PROBLEMS ITERATIONS SKIP…\n";
    return 2;
  }
  const auto problems = read(words[1]);
  const auto iterations = std::stoul(words[2]);
  for (int k = 3; k < count; ++k) {
    for (const auto& problem : problems) attempt(problem, std::stoul(words[k]), iterations);
  }
}
