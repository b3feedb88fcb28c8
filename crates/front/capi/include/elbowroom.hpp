// Proximity queries of robots and cells for C++17: elbowroom.h with handles that free themselves and errors that are thrown.
#ifndef ELBOWROOM_HPP
#define ELBOWROOM_HPP

#include "elbowroom.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace elbowroom {

using Answer = elbowroom_answer;
using Pose = elbowroom_pose;

/// What is wrong, where, and what to write instead.
class Error : public std::runtime_error {
public:
    explicit Error(elbowroom_status status) : std::runtime_error(elbowroom_last_error()), status(status) {}
    const elbowroom_status status;
};

inline void check(elbowroom_status status)
{
    if (status != ELBOWROOM_OK)
        throw Error(status);
}

/// Lower and upper limits of the joints of a robot, rad or m.
struct Limits {
    std::vector<double> lower, upper;
};

/// Robots and objects. Constant: threads share it.
class Model {
public:
    static Model load_cell(const std::string &path, const char *regions = nullptr)
    {
        elbowroom_model *model = nullptr;
        check(elbowroom_model_load_cell(path.c_str(), regions, &model));
        return Model(model);
    }

    static Model load_robot(const std::string &path, const char *srdf = nullptr, const char *pairs = nullptr)
    {
        elbowroom_model *model = nullptr;
        check(elbowroom_model_load_robot(path.c_str(), srdf, pairs, &model));
        return Model(model);
    }

    static Model load_robots(const std::vector<elbowroom_robot_file> &robots, const char *pairs = nullptr)
    {
        elbowroom_model *model = nullptr;
        check(elbowroom_model_load_robots(robots.data(), robots.size(), pairs, &model));
        return Model(model);
    }

    std::vector<std::string> warnings() const
    {
        std::vector<std::string> texts(number([&](auto n) { return elbowroom_model_warning_count(get(), n); }));
        for (size_t i = 0; i < texts.size(); i++)
            texts[i] = text([&](auto t) { return elbowroom_model_warning(get(), i, t); });
        return texts;
    }

    size_t robots() const
    {
        return number([&](auto n) { return elbowroom_model_robot_count(get(), n); });
    }

    const char *robot_name(size_t robot) const
    {
        return text([&](auto t) { return elbowroom_model_robot_name(get(), robot, t); });
    }

    size_t find_robot(const char *name) const
    {
        return number([&](auto n) { return elbowroom_model_find_robot(get(), name, n); });
    }

    size_t joints(size_t robot) const
    {
        return number([&](auto n) { return elbowroom_model_joint_count(get(), robot, n); });
    }

    const char *joint_name(size_t robot, size_t joint) const
    {
        return text([&](auto t) { return elbowroom_model_joint_name(get(), robot, joint, t); });
    }

    Limits joint_limits(size_t robot) const
    {
        Limits limits{std::vector<double>(joints(robot)), std::vector<double>(joints(robot))};
        check(elbowroom_model_joint_limits(get(), robot, limits.lower.data(), limits.upper.data(), limits.lower.size()));
        return limits;
    }

    std::vector<double> start(size_t robot) const
    {
        std::vector<double> q(joints(robot));
        check(elbowroom_model_start(get(), robot, q.data(), q.size()));
        return q;
    }

    size_t links(size_t robot) const
    {
        return number([&](auto n) { return elbowroom_model_link_count(get(), robot, n); });
    }

    const char *link_name(size_t robot, size_t link) const
    {
        return text([&](auto t) { return elbowroom_model_link_name(get(), robot, link, t); });
    }

    size_t find_link(size_t robot, const char *name) const
    {
        return number([&](auto n) { return elbowroom_model_find_link(get(), robot, name, n); });
    }

    size_t objects() const
    {
        return number([&](auto n) { return elbowroom_model_object_count(get(), n); });
    }

    const char *object_name(size_t object) const
    {
        return text([&](auto t) { return elbowroom_model_object_name(get(), object, t); });
    }

    const elbowroom_model *get() const { return handle.get(); }

private:
    struct Free {
        void operator()(elbowroom_model *model) const { elbowroom_model_free(model); }
    };

    explicit Model(elbowroom_model *model) : handle(model) {}

    template <typename Call> static size_t number(Call call)
    {
        size_t value = 0;
        check(call(&value));
        return value;
    }

    template <typename Call> static const char *text(Call call)
    {
        const char *value = nullptr;
        check(call(&value));
        return value;
    }

    std::unique_ptr<elbowroom_model, Free> handle;
};

/// Joint values, and what earlier answers taught. One per thread.
class Checker {
public:
    explicit Checker(const Model &model, elbowroom_level level = ELBOWROOM_LEVEL_AUTO, const char *between = nullptr)
    {
        elbowroom_checker *checker = nullptr;
        check(elbowroom_checker_new(model.get(), level, between, &checker));
        handle.reset(checker);
    }

    void restart() { check(elbowroom_checker_restart(handle.get())); }

    void set_q(size_t robot, const double *q, size_t count) { check(elbowroom_checker_set_q(handle.get(), robot, q, count)); }

    void set_q(size_t robot, const std::vector<double> &q) { set_q(robot, q.data(), q.size()); }

    Pose link_pose(size_t robot, size_t link)
    {
        Pose pose;
        check(elbowroom_checker_link_pose(handle.get(), robot, link, &pose));
        return pose;
    }

    Answer collision()
    {
        Answer answer;
        check(elbowroom_checker_collision(handle.get(), &answer));
        return answer;
    }

    Answer distance()
    {
        Answer answer;
        check(elbowroom_checker_distance(handle.get(), &answer));
        return answer;
    }

    Answer within(double tolerance_m)
    {
        Answer answer;
        check(elbowroom_checker_within(handle.get(), tolerance_m, &answer));
        return answer;
    }

    std::vector<Answer> all_pairs(double margin_m)
    {
        std::vector<Answer> answers(16);
        for (;;) {
            size_t count = 0;
            const auto status =
                elbowroom_checker_all_pairs(handle.get(), margin_m, answers.data(), answers.size(), &count);
            if (status != ELBOWROOM_TOO_SHORT)
                check(status);
            answers.resize(count);
            if (status == ELBOWROOM_OK)
                return answers;
        }
    }

private:
    struct Free {
        void operator()(elbowroom_checker *checker) const { elbowroom_checker_free(checker); }
    };

    std::unique_ptr<elbowroom_checker, Free> handle;
};

} // namespace elbowroom

#endif
