// Two arms of one model side by side: collision and distance of random configurations, as CSV.
//
//     two_arms MODEL METRES STATES [SEED]    two arms, METRES apart along y, with the .srdf beside the model
//     two_arms CELL.toml STATES [SEED]       the robots of a cell
//
// The columns are the joint values, then those of `elbowroom query --ask distance`, then the pair that
// `--ask collision` names. All processors work: they share the model, and each thread has its own checkers.

#include <elbowroom.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

using elbowroom::Answer;
using elbowroom::Checker;
using elbowroom::Model;

Model two_arms(const char *path, double metres)
{
    const std::string srdf = std::filesystem::path(path).replace_extension(".srdf").string();
    const char *disabled_pairs = std::filesystem::exists(srdf) ? srdf.c_str() : nullptr;
    const auto arm = [&](const char *name, double y) {
        const elbowroom_pose base{{0.0, y, 0.0}, {0.0, 0.0, 0.0, 1.0}};
        return elbowroom_robot_file{name, path, disabled_pairs, nullptr, nullptr, base};
    };
    return Model::load_robots({arm("left", 0.0), arm("right", metres)});
}

// Joints without limits turn once.
std::vector<double> random_q(const elbowroom::Limits &limits, std::mt19937_64 &random)
{
    std::vector<double> q(limits.lower.size());
    for (size_t i = 0; i < q.size(); i++) {
        const double lower = std::isfinite(limits.lower[i]) ? limits.lower[i] : -M_PI;
        const double upper = std::isfinite(limits.upper[i]) ? limits.upper[i] : M_PI;
        q[i] = std::uniform_real_distribution<double>(lower, std::nextafter(upper, INFINITY))(random);
    }
    return q;
}

// 17 digits are the number to the bit.
void add(std::string &text, double value)
{
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", value);
    text += std::isfinite(value) ? digits : "";
    text += ',';
}

void add(std::string &text, const Answer &answer)
{
    static const char *const levels[] = {"auto", "L1", "L2", "capsule", "hull", "L3"};
    text += answer.collides ? "1," : "0,";
    add(text, answer.distance_m);
    text.append(answer.a ? answer.a : "").append(",").append(answer.b ? answer.b : "").append(",");
    for (const double v : answer.point_a_m)
        add(text, v);
    for (const double v : answer.point_b_m)
        add(text, v);
    text.append(levels[answer.level]).append(",");
}

using State = std::vector<std::vector<double>>;

struct Times {
    std::atomic<long long> collision_ns{0}, distance_ns{0};
};

// A block starts with checkers that have learned nothing, as in the command: its rows do not depend on the thread.
std::string rows(const std::vector<State> &states, size_t begin, Checker &collision, Checker &distance, Times &times)
{
    const size_t end = std::min(states.size(), begin + ELBOWROOM_BLOCK);
    std::vector<Answer> contacts(end - begin), nearest(end - begin);
    const auto ask = [&](Checker &checker, std::vector<Answer> &answers, std::atomic<long long> &ns, auto question) {
        checker.restart();
        const auto start = std::chrono::steady_clock::now();
        for (size_t i = begin; i < end; i++) {
            for (size_t robot = 0; robot < states[i].size(); robot++)
                checker.set_q(robot, states[i][robot]);
            answers[i - begin] = question(checker);
        }
        ns += std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
    };
    ask(collision, contacts, times.collision_ns, [](Checker &checker) { return checker.collision(); });
    ask(distance, nearest, times.distance_ns, [](Checker &checker) { return checker.distance(); });
    std::string text;
    for (size_t i = begin; i < end; i++) {
        for (const auto &q : states[i])
            for (const double value : q)
                add(text, value);
        const Answer &contact = contacts[i - begin];
        add(text, nearest[i - begin]);
        text.append(contact.a ? contact.a : "").append(",").append(contact.b ? contact.b : "").append("\n");
    }
    return text;
}

void print_header(const Model &model)
{
    for (size_t robot = 0; robot < model.robots(); robot++)
        for (size_t joint = 0; joint < model.joints(robot); joint++)
            std::printf("%s.%s,", model.robot_name(robot), model.joint_name(robot, joint));
    std::printf("collides,distance_m,a,b,ax,ay,az,bx,by,bz,level,contact_a,contact_b\n");
}

void print_rows(const Model &model, size_t count, unsigned long seed)
{
    std::mt19937_64 random(seed);
    std::vector<State> states(count, State(model.robots()));
    for (size_t robot = 0; robot < model.robots(); robot++) {
        const auto limits = model.joint_limits(robot);
        for (auto &state : states)
            state[robot] = random_q(limits, random);
    }
    std::vector<std::string> blocks((count + ELBOWROOM_BLOCK - 1) / ELBOWROOM_BLOCK);
    const size_t cores = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::exception_ptr> errors(cores);
    std::atomic<size_t> next{0};
    Times times;
    const auto work = [&](size_t core) {
        try {
            Checker collision(model), distance(model);
            for (size_t block; (block = next++) < blocks.size();)
                blocks[block] = rows(states, block * ELBOWROOM_BLOCK, collision, distance, times);
        } catch (...) {
            errors[core] = std::current_exception();
        }
    };
    std::vector<std::thread> threads;
    for (size_t core = 0; core < cores; core++)
        threads.emplace_back(work, core);
    for (auto &thread : threads)
        thread.join();
    for (const auto &error : errors)
        if (error)
            std::rethrow_exception(error);
    print_header(model);
    for (const auto &block : blocks)
        std::fwrite(block.data(), 1, block.size(), stdout);
    const double us = 1e-3 / double(std::max<size_t>(count, 1));
    std::fprintf(stderr, "elbowroom %s: %zu states on %zu threads, collision %.3f us, distance %.3f us per state\n",
                 elbowroom_version(), count, cores, us * double(times.collision_ns), us * double(times.distance_ns));
}

} // namespace

int main(int argc, char **argv)
{
    const std::string path = argc > 1 ? argv[1] : "";
    const bool is_cell = path.size() > 5 && path.compare(path.size() - 5, 5, ".toml") == 0;
    const int states = is_cell ? 2 : 3;
    if (argc <= states || argc > states + 2) {
        std::fprintf(stderr, "two_arms MODEL METRES STATES [SEED]\ntwo_arms CELL.toml STATES [SEED]\n");
        return 2;
    }
    try {
        const Model model = is_cell ? Model::load_cell(path) : two_arms(argv[1], std::strtod(argv[2], nullptr));
        for (const auto &warning : model.warnings())
            std::fprintf(stderr, "warning: %s\n", warning.c_str());
        print_rows(model, std::strtoull(argv[states], nullptr, 10),
                   argc > states + 1 ? std::strtoul(argv[states + 1], nullptr, 10) : 1);
    } catch (const elbowroom::Error &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
