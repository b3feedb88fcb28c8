/*
 * Calls every function, rightly and wrongly, and prints what the test in Rust compares:
 *
 *     calls FOLDER      cell.toml, arm.urdf, broken.urdf, broken.toml of the test are in FOLDER
 */
#include "elbowroom.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An array of negative length does not compile. */
#define STATIC_ASSERT(name, condition) typedef char name[(condition) ? 1 : -1]

STATIC_ASSERT(ok_is_0, ELBOWROOM_OK == 0);
STATIC_ASSERT(null_pointer_is_1, ELBOWROOM_NULL_POINTER == 1);
STATIC_ASSERT(invalid_value_is_2, ELBOWROOM_INVALID_VALUE == 2);
STATIC_ASSERT(unknown_name_is_3, ELBOWROOM_UNKNOWN_NAME == 3);
STATIC_ASSERT(file_is_4, ELBOWROOM_FILE == 4);
STATIC_ASSERT(too_short_is_5, ELBOWROOM_TOO_SHORT == 5);
STATIC_ASSERT(panic_is_6, ELBOWROOM_PANIC == 6);
STATIC_ASSERT(poisoned_is_7, ELBOWROOM_POISONED == 7);
STATIC_ASSERT(level_auto_is_0, ELBOWROOM_LEVEL_AUTO == 0);
STATIC_ASSERT(level_l1_is_1, ELBOWROOM_LEVEL_L1 == 1);
STATIC_ASSERT(level_l2_is_2, ELBOWROOM_LEVEL_L2 == 2);
STATIC_ASSERT(level_capsule_is_3, ELBOWROOM_LEVEL_CAPSULE == 3);
STATIC_ASSERT(level_hull_is_4, ELBOWROOM_LEVEL_HULL == 4);
STATIC_ASSERT(level_l3_is_5, ELBOWROOM_LEVEL_L3 == 5);

#define PRINT_OFFSET(type, field) printf("%s.%s %zu\n", #type, #field, offsetof(type, field))

static int faults = 0;

/* The status must be this, and of an error the text must contain `part`. */
static void expect(int line, elbowroom_status status, elbowroom_status expected, const char *part)
{
    const char *text = elbowroom_last_error();
    if (status == expected && (expected == ELBOWROOM_OK || strstr(text, part) != NULL))
        return;
    fprintf(stderr, "line %d: status %d, not %d with \"%s\"; the last error is: %s\n", line, (int)status, (int)expected,
            part, text);
    faults++;
}

static void hold(int line, int condition)
{
    if (condition)
        return;
    fprintf(stderr, "line %d: does not hold; the last error is: %s\n", line, elbowroom_last_error());
    faults++;
}

#define OK(call) expect(__LINE__, call, ELBOWROOM_OK, "")
#define FAILS(call, status, part) expect(__LINE__, call, status, part)
#define HOLDS(condition) hold(__LINE__, condition)

static char folder[1024];

static const char *file(const char *name)
{
    static char path[4][2048];
    static int next = 0;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static elbowroom_robot_file robot_file(const char *name, const char *path, double y)
{
    elbowroom_robot_file robot;
    memset(&robot, 0, sizeof robot);
    robot.name = name;
    robot.path = path;
    robot.base_in_world.position_m[1] = y;
    robot.base_in_world.quaternion_xyzw[3] = 1.0;
    return robot;
}

static void print_layout(void)
{
    PRINT_OFFSET(elbowroom_pose, position_m);
    PRINT_OFFSET(elbowroom_pose, quaternion_xyzw);
    printf("elbowroom_pose %zu\n", sizeof(elbowroom_pose));
    PRINT_OFFSET(elbowroom_robot_file, name);
    PRINT_OFFSET(elbowroom_robot_file, path);
    PRINT_OFFSET(elbowroom_robot_file, srdf);
    PRINT_OFFSET(elbowroom_robot_file, joints);
    PRINT_OFFSET(elbowroom_robot_file, unit);
    PRINT_OFFSET(elbowroom_robot_file, base_in_world);
    printf("elbowroom_robot_file %zu\n", sizeof(elbowroom_robot_file));
    PRINT_OFFSET(elbowroom_answer, collides);
    PRINT_OFFSET(elbowroom_answer, level);
    PRINT_OFFSET(elbowroom_answer, distance_m);
    PRINT_OFFSET(elbowroom_answer, a);
    PRINT_OFFSET(elbowroom_answer, b);
    PRINT_OFFSET(elbowroom_answer, point_a_m);
    PRINT_OFFSET(elbowroom_answer, point_b_m);
    printf("elbowroom_answer %zu\n", sizeof(elbowroom_answer));
}

static void loading(void)
{
    elbowroom_model *model = NULL;
    const elbowroom_robot_file pair[2] = {robot_file("left", file("arm.urdf"), 0.0),
                                          robot_file("right", file("arm.urdf"), 0.5)};
    elbowroom_robot_file wrong[2];
    const char *const bad_names[] = {"left", "", " x", "a/b", "a,b", "a;b"};
    size_t i, count = 7;
    HOLDS(strchr(elbowroom_version(), '.') != NULL);
    HOLDS(strcmp(elbowroom_last_error(), "") == 0);
    FAILS(elbowroom_model_load_cell(NULL, NULL, &model), ELBOWROOM_NULL_POINTER, "`path` is NULL");
    FAILS(elbowroom_model_load_cell(file("cell.toml"), NULL, NULL), ELBOWROOM_NULL_POINTER, "`model` is NULL");
    FAILS(elbowroom_model_load_cell(file("none.toml"), NULL, &model), ELBOWROOM_FILE, "none.toml: cannot be read");
    FAILS(elbowroom_model_load_cell(file("broken.toml"), NULL, &model), ELBOWROOM_FILE, "broken.toml:3:");
    HOLDS(model == NULL);
    FAILS(elbowroom_model_load_cell(file("cell.toml"), "corn", &model), ELBOWROOM_UNKNOWN_NAME, "corner");
    FAILS(elbowroom_model_load_cell(file("cell.toml"), "", &model), ELBOWROOM_UNKNOWN_NAME, "corner");
    FAILS(elbowroom_model_load_cell("\xff\xfe", NULL, &model), ELBOWROOM_INVALID_VALUE, "not UTF-8");
    FAILS(elbowroom_model_load_robot(NULL, NULL, NULL, &model), ELBOWROOM_NULL_POINTER, "`path`");
    FAILS(elbowroom_model_load_robot(file("none.urdf"), NULL, NULL, &model), ELBOWROOM_FILE, "none.urdf");
    FAILS(elbowroom_model_load_robot(file("broken.urdf"), NULL, NULL, &model), ELBOWROOM_FILE, "broken.urdf");
    FAILS(elbowroom_model_load_robot(folder, NULL, NULL, &model), ELBOWROOM_FILE, folder);
    FAILS(elbowroom_model_load_robot(file("arm.urdf"), file("none.srdf"), NULL, &model), ELBOWROOM_FILE, "none.srdf");
    FAILS(elbowroom_model_load_robot(file("arm.urdf"), NULL, file("none.toml"), &model), ELBOWROOM_FILE, "none.toml");
    FAILS(elbowroom_model_load_robots(NULL, 1, NULL, &model), ELBOWROOM_NULL_POINTER, "`robots`");
    FAILS(elbowroom_model_load_robots(pair, 0, NULL, &model), ELBOWROOM_INVALID_VALUE, "no robot");
    FAILS(elbowroom_model_load_robots(pair, SIZE_MAX, NULL, &model), ELBOWROOM_INVALID_VALUE, "cannot be an array");
    for (i = 0; i < sizeof bad_names / sizeof bad_names[0]; i++) {
        wrong[0] = pair[0];
        wrong[1] = robot_file(bad_names[i], file("arm.urdf"), 0.5);
        FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_INVALID_VALUE, "a name of its own");
    }
    wrong[1] = robot_file(NULL, file("arm.urdf"), 0.5);
    FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_NULL_POINTER, "`name`");
    wrong[1] = robot_file("right", file("arm.urdf"), NAN);
    FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_INVALID_VALUE, "the base of `right`");
    wrong[1].base_in_world = pair[1].base_in_world;
    wrong[1].base_in_world.quaternion_xyzw[3] = 0.0;
    FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_INVALID_VALUE, "quaternion");
    wrong[1].base_in_world.quaternion_xyzw[3] = 2.0;
    FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_INVALID_VALUE, "length 1");
    wrong[1] = pair[1];
    wrong[1].unit = "ft";
    FAILS(elbowroom_model_load_robots(wrong, 2, NULL, &model), ELBOWROOM_INVALID_VALUE, "m, cm, mm or in");
    HOLDS(model == NULL);
    wrong[1].unit = "mm";
    OK(elbowroom_model_load_robots(wrong, 2, NULL, &model));
    OK(elbowroom_model_robot_count(model, &count));
    HOLDS(count == 2);
    elbowroom_model_free(model);
    elbowroom_model_free(NULL);
}

static void names(const elbowroom_model *model)
{
    const char *text = NULL;
    double lower[3], upper[3], q[3];
    size_t n = 7;
    OK(elbowroom_model_warning_count(model, &n));
    FAILS(elbowroom_model_warning(model, n, &text), ELBOWROOM_INVALID_VALUE, "no warning");
    OK(elbowroom_model_robot_count(model, &n));
    HOLDS(n == 2);
    OK(elbowroom_model_robot_name(model, 1, &text));
    HOLDS(strcmp(text, "right") == 0);
    OK(elbowroom_model_find_robot(model, "right", &n));
    HOLDS(n == 1);
    FAILS(elbowroom_model_find_robot(model, "rigth", &n), ELBOWROOM_UNKNOWN_NAME, "did you mean");
    FAILS(elbowroom_model_find_robot(model, NULL, &n), ELBOWROOM_NULL_POINTER, "`name`");
    FAILS(elbowroom_model_find_robot(model, "right", NULL), ELBOWROOM_NULL_POINTER, "`robot`");
    HOLDS(n == 1);
    FAILS(elbowroom_model_robot_name(model, 2, &text), ELBOWROOM_INVALID_VALUE, "there are 2");
    FAILS(elbowroom_model_robot_name(NULL, 0, &text), ELBOWROOM_NULL_POINTER, "`model`");
    OK(elbowroom_model_joint_count(model, 0, &n));
    HOLDS(n == 2);
    FAILS(elbowroom_model_joint_count(model, SIZE_MAX, &n), ELBOWROOM_INVALID_VALUE, "no robot");
    OK(elbowroom_model_joint_name(model, 0, 1, &text));
    HOLDS(strcmp(text, "elbow") == 0);
    FAILS(elbowroom_model_joint_name(model, 0, 2, &text), ELBOWROOM_INVALID_VALUE, "no joint 2");
    OK(elbowroom_model_joint_limits(model, 0, lower, upper, 2));
    HOLDS(lower[0] == -3.0 && upper[0] == 3.0 && lower[1] == 0.25 && upper[1] == 2.0);
    FAILS(elbowroom_model_joint_limits(model, 0, lower, upper, 3), ELBOWROOM_INVALID_VALUE, "write: 2");
    FAILS(elbowroom_model_joint_limits(model, 0, lower, NULL, 2), ELBOWROOM_NULL_POINTER, "`upper`");
    OK(elbowroom_model_start(model, 1, q, 2));
    HOLDS(q[0] == 0.0 && q[1] == 0.25);
    FAILS(elbowroom_model_start(model, 1, q, 1), ELBOWROOM_INVALID_VALUE, "write: 2");
    OK(elbowroom_model_link_count(model, 0, &n));
    HOLDS(n == 3);
    OK(elbowroom_model_link_name(model, 0, 2, &text));
    HOLDS(strcmp(text, "forearm") == 0);
    FAILS(elbowroom_model_link_name(model, 0, 3, &text), ELBOWROOM_INVALID_VALUE, "no link 3");
    OK(elbowroom_model_find_link(model, 0, "forearm", &n));
    HOLDS(n == 2);
    FAILS(elbowroom_model_find_link(model, 0, "foreram", &n), ELBOWROOM_UNKNOWN_NAME, "forearm");
    OK(elbowroom_model_object_count(model, &n));
    HOLDS(n == 0);
    FAILS(elbowroom_model_object_name(model, 0, &text), ELBOWROOM_INVALID_VALUE, "no object 0");
}

static void print_answer(const char *what, const elbowroom_answer *a)
{
    printf("%s %d %d %.17g %s %s %.17g %.17g %.17g %.17g %.17g %.17g\n", what, a->collides, a->level, a->distance_m,
           a->a ? a->a : "-", a->b ? a->b : "-", a->point_a_m[0], a->point_a_m[1], a->point_a_m[2], a->point_b_m[0],
           a->point_b_m[1], a->point_b_m[2]);
}

/* An answer of an error must not look free. */
static void refused(int line, elbowroom_status status, elbowroom_status expected, const char *part, elbowroom_answer *answer)
{
    expect(line, status, expected, part);
    hold(line, answer->collides == 1 && isnan(answer->distance_m) && answer->a == NULL);
    memset(answer, 0, sizeof *answer);
}

static void queries(const elbowroom_model *model)
{
    elbowroom_checker *checker = NULL, *named = NULL;
    elbowroom_answer answer, answers[16];
    elbowroom_pose pose;
    const double q[2] = {0.5, 1.0}, nan_q[2] = {0.5, NAN}, infinite_q[2] = {INFINITY, 1.0};
    size_t count = 77;
    memset(&answer, 0, sizeof answer);
    FAILS(elbowroom_checker_new(NULL, ELBOWROOM_LEVEL_AUTO, NULL, &checker), ELBOWROOM_NULL_POINTER, "`model`");
    FAILS(elbowroom_checker_new(model, ELBOWROOM_LEVEL_AUTO, NULL, NULL), ELBOWROOM_NULL_POINTER, "`checker`");
    FAILS(elbowroom_checker_new(model, 6, NULL, &checker), ELBOWROOM_INVALID_VALUE, "6 is no resolution level");
    FAILS(elbowroom_checker_new(model, -1, NULL, &checker), ELBOWROOM_INVALID_VALUE, "-1 is no resolution level");
    FAILS(elbowroom_checker_new(model, 0, "left,rihgt", &checker), ELBOWROOM_UNKNOWN_NAME, "right");
    FAILS(elbowroom_checker_new(model, 0, "left", &checker), ELBOWROOM_INVALID_VALUE, "no pair");
    FAILS(elbowroom_checker_new(model, 0, "", &checker), ELBOWROOM_INVALID_VALUE, "no pair");
    FAILS(elbowroom_checker_new(model, 0, "left/base,left/upper_arm", &checker), ELBOWROOM_INVALID_VALUE, "no pair that could meet");
    HOLDS(checker == NULL);
    OK(elbowroom_checker_new(model, ELBOWROOM_LEVEL_AUTO, NULL, &checker));
    OK(elbowroom_checker_new(model, ELBOWROOM_LEVEL_L3, "left/forearm,right/base", &named));

    OK(elbowroom_checker_set_q(checker, 0, q, 2));
    OK(elbowroom_checker_set_q(named, 0, q, 2));
    FAILS(elbowroom_checker_set_q(NULL, 0, q, 2), ELBOWROOM_NULL_POINTER, "`checker`");
    FAILS(elbowroom_checker_set_q(checker, 2, q, 2), ELBOWROOM_INVALID_VALUE, "no robot 2");
    FAILS(elbowroom_checker_set_q(checker, 0, NULL, 2), ELBOWROOM_NULL_POINTER, "`q`");
    FAILS(elbowroom_checker_set_q(checker, 0, NULL, 0), ELBOWROOM_INVALID_VALUE, "shoulder, elbow");
    FAILS(elbowroom_checker_set_q(checker, 0, q, 1), ELBOWROOM_INVALID_VALUE, "takes 2 joint values");
    FAILS(elbowroom_checker_set_q(checker, 0, q, SIZE_MAX / 4), ELBOWROOM_INVALID_VALUE, "cannot be an array");
    FAILS(elbowroom_checker_set_q(checker, 0, nan_q, 2), ELBOWROOM_INVALID_VALUE, "elbow");
    FAILS(elbowroom_checker_set_q(checker, 0, infinite_q, 2), ELBOWROOM_INVALID_VALUE, "shoulder");
    FAILS(elbowroom_checker_link_pose(checker, 0, 3, &pose), ELBOWROOM_INVALID_VALUE, "no link 3");
    FAILS(elbowroom_checker_link_pose(checker, 0, 2, NULL), ELBOWROOM_NULL_POINTER, "`pose`");
    FAILS(elbowroom_checker_collision(checker, NULL), ELBOWROOM_NULL_POINTER, "`answer`");
    refused(__LINE__, elbowroom_checker_collision(NULL, &answer), ELBOWROOM_NULL_POINTER, "`checker`", &answer);
    refused(__LINE__, elbowroom_checker_distance(NULL, &answer), ELBOWROOM_NULL_POINTER, "`checker`", &answer);
    refused(__LINE__, elbowroom_checker_within(checker, NAN, &answer), ELBOWROOM_INVALID_VALUE, "`tolerance_m`", &answer);
    refused(__LINE__, elbowroom_checker_within(checker, -0.1, &answer), ELBOWROOM_INVALID_VALUE, "metres", &answer);
    FAILS(elbowroom_checker_all_pairs(checker, NAN, answers, 8, &count), ELBOWROOM_INVALID_VALUE, "`margin_m`");
    FAILS(elbowroom_checker_all_pairs(checker, 9.0, NULL, 8, &count), ELBOWROOM_NULL_POINTER, "`answers`");
    FAILS(elbowroom_checker_all_pairs(checker, 9.0, answers, 8, NULL), ELBOWROOM_NULL_POINTER, "`count`");
    HOLDS(count == 77);
    FAILS(elbowroom_checker_restart(NULL), ELBOWROOM_NULL_POINTER, "`checker`");

    /* After all these errors the joint values are as before. */
    OK(elbowroom_checker_link_pose(checker, 0, 2, &pose));
    printf("pose %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", pose.position_m[0], pose.position_m[1], pose.position_m[2],
           pose.quaternion_xyzw[0], pose.quaternion_xyzw[1], pose.quaternion_xyzw[2], pose.quaternion_xyzw[3]);
    OK(elbowroom_checker_collision(checker, &answer));
    print_answer("collision", &answer);
    OK(elbowroom_checker_restart(checker));
    OK(elbowroom_checker_distance(checker, &answer));
    print_answer("distance", &answer);
    OK(elbowroom_checker_within(checker, 0.001, &answer));
    print_answer("within", &answer);
    OK(elbowroom_checker_within(checker, 9.0, &answer));
    print_answer("within", &answer);
    OK(elbowroom_checker_distance(named, &answer));
    print_answer("named", &answer);
    FAILS(elbowroom_checker_all_pairs(checker, 9.0, NULL, 0, &count), ELBOWROOM_TOO_SHORT, "do not fit into 0 places");
    HOLDS(count > 1 && count <= 16);
    OK(elbowroom_checker_all_pairs(checker, 9.0, answers, 16, &count));
    while (count > 0)
        print_answer("pair", &answers[--count]);
    elbowroom_checker_free(checker);
    elbowroom_checker_free(named);
    elbowroom_checker_free(NULL);
}

/* A checker keeps what it needs of its model. */
static void order_of_freeing(void)
{
    elbowroom_model *model = NULL;
    elbowroom_checker *checker = NULL;
    elbowroom_answer answer;
    const char *text = NULL;
    size_t n = 0;
    OK(elbowroom_model_load_cell(file("cell.toml"), " corner ,corner", &model));
    OK(elbowroom_model_object_count(model, &n));
    HOLDS(n == 2);
    OK(elbowroom_model_object_name(model, 1, &text));
    HOLDS(strcmp(text, "corner") == 0);
    OK(elbowroom_checker_new(model, ELBOWROOM_LEVEL_AUTO, NULL, &checker));
    elbowroom_model_free(model);
    OK(elbowroom_checker_distance(checker, &answer));
    print_answer("cell", &answer);
    elbowroom_checker_free(checker);
}

int main(int argc, char **argv)
{
    elbowroom_model *model = NULL;
    elbowroom_robot_file robots[2];
    if (argc != 2)
        return 2;
    snprintf(folder, sizeof folder, "%s", argv[1]);
    print_layout();
    loading();
    robots[0] = robot_file("left", file("arm.urdf"), 0.0);
    robots[1] = robot_file("right", file("arm.urdf"), 0.5);
    OK(elbowroom_model_load_robots(robots, 2, NULL, &model));
    names(model);
    queries(model);
    elbowroom_model_free(model);
    order_of_freeing();
    return faults == 0 ? 0 : 1;
}
