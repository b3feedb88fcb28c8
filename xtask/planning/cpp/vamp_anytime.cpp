// VAMP's AORRTC and FCIT* on a file of problems: which paths they find with more time.
//
// usage: vamp_anytime PROBLEMS aorrtc|fcit MILLISECONDS SKIP
// The Halton sequence of each problem starts SKIP states later.
// Printed: an attempt per line, as xtask/planning/README.md has it. A time is that from the call until the path is
// returned, simplified, without building the scene.
#include <chrono>
#include <iostream>

#include "vamp_problems.hpp"

#include <vamp/planning/aorrtc.hh>
#include <vamp/planning/fcit.hh>
#include <vamp/planning/simplify.hh>

namespace planning = vamp::planning;
using Clock = std::chrono::steady_clock;
using RRTC = planning::RRTC<Robot, rake, Robot::resolution>;
using AOX = planning::AOX_RRTC<Robot, rake, Robot::resolution>;
using FCIT = planning::FCIT<Robot, rake, Robot::resolution>;

// Result of an attempt: the shortest path, and time and length of each path.
struct Answer {
  Clock::time_point begin = Clock::now();
  Path path;
  std::vector<std::pair<double, double>> improvements;

  double microseconds() const { return std::chrono::duration<double, std::micro>(Clock::now() - begin).count(); }

  void add(double time, const Path& other) {
    improvements.emplace_back(time, length(other));
    if (path.empty() || length(other) < length(path)) path = other;
  }
};

static Path simplified(const Path& path, const WideScene& scene, vamp::rng::RNG<Robot>::Ptr rng) {
  return planning::simplify<Robot, rake, Robot::resolution>(path, scene, {}, rng).path;
}

static auto halton(std::size_t skip) {
  auto states = std::make_shared<vamp::rng::Halton<Robot>>();
  for (std::size_t i = 0; i < skip; ++i) states->next();
  return states;
}

// Halton's sequence with a deadline: when it is over, a limit of the search that asks for samples becomes zero. Otherwise a
// search ends at a number of iterations only.
struct Timed : vamp::rng::RNG<Robot> {
  Timed(std::shared_ptr<vamp::rng::Halton<Robot>> states, Clock::time_point end, std::size_t& limit)
    : states(std::move(states)), end(end), limit(limit) {}

  void reset() noexcept override { states->reset(); }

  vamp::FloatVector<Robot::dimension> next() noexcept override {
    if (++count % 16 == 0 && is_over()) limit = 0;
    return states->next();
  }

  bool is_over() const { return Clock::now() >= end; }

  std::shared_ptr<vamp::rng::Halton<Robot>> states;
  Clock::time_point end;
  std::size_t& limit;
  std::size_t count = 0;
};

// AORRTC from VAMP's searches, in the order of its own `AORRTC::solve`, which tells no lengths in between and has no
// deadline. A path that is complete after the deadline does not count.
static Answer aorrtc(const Problem& problem, const WideScene& scene, double limit_us, std::size_t skip) {
  auto states = halton(skip);
  Answer answer;
  planning::AORRTCSettings settings;
  settings.rrtc.range = 1.0;
  const auto most = settings.rrtc.max_iterations;
  const auto end = answer.begin + std::chrono::nanoseconds(std::int64_t(1000 * limit_us));
  auto timed = std::make_shared<Timed>(states, end, settings.rrtc.max_iterations);
  vamp::rng::RNG<Robot>::Ptr rng = timed;
  const auto take = [&](const Path& found) {
    if (found.empty()) return;
    const auto path = simplified(found, scene, rng);
    const double time = answer.microseconds();
    if (time <= limit_us) answer.add(time, path);
  };
  const std::vector goals{problem.goal};
  while (answer.path.empty() && !timed->is_over()) {
    settings.rrtc.max_iterations = most;
    take(RRTC::solve(problem.start, goals, scene, settings.rrtc, rng).path);
  }
  if (answer.path.size() <= 2) return answer;
  planning::ProlateHyperspheroid<Robot> ellipsoid(problem.start, problem.goal);
  ellipsoid.set_transverse_diameter(length(answer.path));
  auto informed = std::make_shared<planning::ProlateHyperspheroidRNG<Robot>>(ellipsoid, rng);
  AOX search(settings.max_samples);
  const double straight = problem.start.distance(problem.goal);
  while (!timed->is_over() && length(answer.path) - straight > 1e-8) {
    settings.rrtc.max_iterations = most;
    take(search.solve(problem.start, goals, scene, settings, length(answer.path), informed).path);
    informed->phs.set_transverse_diameter(length(answer.path));
  }
  return answer;
}

// FCIT* tells its path when it ends only: each number of batches is a run of its own, with its own time.
static void add_runs(const Problem& problem, const WideScene& scene, std::size_t batch, double limit_us, std::size_t skip,
                     Answer& answer) {
  planning::FCITStarNeighborParams neighbours(Robot::dimension, Robot::space_measure());
  planning::RoadmapSettings<planning::FCITStarNeighborParams> settings(neighbours);
  settings.optimize = true;
  settings.batch_size = batch;
  for (std::size_t batches = 0;; batches += 1 + batches / 3) {
    // One sample beyond the last batch: the search after that batch is the last.
    settings.max_samples = 3 + batches * batch;
    vamp::rng::RNG<Robot>::Ptr rng = halton(skip);
    answer.begin = Clock::now();
    auto path = FCIT::solve(problem.start, problem.goal, scene, settings, rng).path;
    // An unsolved problem has one state.
    const bool is_solved = path.size() > 1;
    if (is_solved) path = simplified(path, scene, rng);
    const double time = answer.microseconds();
    if (time > limit_us) return;
    if (is_solved) answer.add(time, path);
    if (path.size() == 2) return;
  }
}

// Batches of 1,000 are the default; the first of them takes milliseconds. With both sizes, the shorter path counts.
static Answer fcit(const Problem& problem, const WideScene& scene, double limit_us, std::size_t skip) {
  Answer answer;
  add_runs(problem, scene, 100, limit_us / 10, skip, answer);
  add_runs(problem, scene, 1000, limit_us, skip, answer);
  return answer;
}

static void attempt(const Problem& problem, const std::string& planner, double limit_us, std::size_t skip) {
  const bool valid = is_valid(problem);
  Answer answer;
  if (valid) answer = (planner == "fcit" ? fcit : aorrtc)(problem, WideScene(problem.scene), limit_us, skip);
  std::printf("{\"set\":\"%s\",\"id\":\"%s\",\"valid\":%s,\"improvements\":[", problem.set.c_str(), problem.id.c_str(),
              valid ? "true" : "false");
  for (std::size_t i = 0; i < answer.improvements.size(); ++i) {
    std::printf("%s[%.3f,%.6f]", i == 0 ? "" : ",", answer.improvements[i].first, answer.improvements[i].second);
  }
  std::printf("],\"path\":[");
  print(answer.path);
  std::printf("]}\n");
}

int main(int count, char** words) {
  const std::string planner = count == 5 ? words[2] : "";
  if (planner != "aorrtc" && planner != "fcit") {
    std::cerr << "usage: vamp_anytime PROBLEMS aorrtc|fcit MILLISECONDS SKIP\n";
    return 2;
  }
  for (const auto& problem : read(words[1])) attempt(problem, planner, 1000 * std::stod(words[3]), std::stoul(words[4]));
}
