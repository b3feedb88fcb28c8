/*
 * Proximity queries of robots and cells, for C99 and C++.
 *
 *     elbowroom_model *model = NULL;
 *     elbowroom_checker *checker = NULL;
 *     elbowroom_answer answer;
 *     const double q[6] = {0.0, -0.5, 1.0, 0.0, 0.5, 0.0};
 *     if (elbowroom_model_load_robot("arm.urdf", "arm.srdf", NULL, &model) != ELBOWROOM_OK
 *         || elbowroom_checker_new(model, ELBOWROOM_LEVEL_AUTO, NULL, &checker) != ELBOWROOM_OK
 *         || elbowroom_checker_set_q(checker, 0, q, 6) != ELBOWROOM_OK
 *         || elbowroom_checker_distance(checker, &answer) != ELBOWROOM_OK)
 *         fprintf(stderr, "%s\n", elbowroom_last_error());
 *     else if (answer.a != NULL)
 *         printf("%s is %g m from %s\n", answer.a, answer.distance_m, answer.b);
 *     elbowroom_checker_free(checker);
 *     elbowroom_model_free(model);
 *
 * Units and frames: metres, radians, seconds; joint values are rad, or m for prismatic joints; points and poses are in
 * the world frame. The world of a single robot is its root link.
 *
 * Answers equal those of `elbowroom query` to the bit (docs/c-api.md).
 *
 * Errors: a function that can fail returns a status, and elbowroom_last_error() says what is wrong, where, and what to
 * write instead. NULL, wrong lengths and numbers that are not finite are errors. On an error results are unchanged, except
 * that a handle becomes NULL and an answer says "collides": an ignored error never reads as "free". After an error the
 * model and the checker are as before.
 *
 * What the caller must keep: a handle comes from this library and is not used after it was freed; a text is NULL or ends
 * with a NUL, in UTF-8; an array has as many elements as its count says; nobody else writes them during the call. Handles
 * and single results must be aligned and not overlap.
 *
 * Threads: a model is constant, any number of threads may use it at the same time. A checker belongs to one thread at a
 * time; make one per thread. The text of an error belongs to the thread of the call that failed. Nothing else is shared.
 */
#ifndef ELBOWROOM_H
#define ELBOWROOM_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call returns. */
typedef enum elbowroom_status {
    ELBOWROOM_OK = 0,
    /* A pointer is NULL that must not be. */
    ELBOWROOM_NULL_POINTER = 1,
    /* A number, a length, an index or a text is not valid. */
    ELBOWROOM_INVALID_VALUE = 2,
    /* No robot, link, object or region has this name. */
    ELBOWROOM_UNKNOWN_NAME = 3,
    /* A file is missing or refused. */
    ELBOWROOM_FILE = 4,
    /* An array is too short for the result. */
    ELBOWROOM_TOO_SHORT = 5,
    /* A fault of the library. The checker of the call refuses all later calls. */
    ELBOWROOM_PANIC = 6,
    /* An earlier fault of the library left the checker in an unknown state: free it. */
    ELBOWROOM_POISONED = 7
} elbowroom_status;

/*
 * The models that a query compares. All except AUTO and L3 enclose the links: "free" is guaranteed, a reported contact may be a
 * false positive, distances are lower bounds.
 */
typedef enum elbowroom_level {
    /* From coarse to exact, as fine as needed; answers like L3. */
    ELBOWROOM_LEVEL_AUTO = 0,
    /* One axis-aligned box per robot and object. */
    ELBOWROOM_LEVEL_L1 = 1,
    /* One oriented box per link and object. */
    ELBOWROOM_LEVEL_L2 = 2,
    /* One capsule per link and object. */
    ELBOWROOM_LEVEL_CAPSULE = 3,
    /* The convex hull of each solid. */
    ELBOWROOM_LEVEL_HULL = 4,
    /* The exact geometry. */
    ELBOWROOM_LEVEL_L3 = 5
} elbowroom_level;

/* Robots and objects. Constant. */
typedef struct elbowroom_model elbowroom_model;

/* Joint values, and what earlier answers taught. One per thread. */
typedef struct elbowroom_checker elbowroom_checker;

/* A pose: rotation by a unit quaternion x, y, z, w, then translation. */
typedef struct elbowroom_pose {
    double position_m[3];
    double quaternion_xyzw[4];
} elbowroom_pose;

/* A robot to load. */
typedef struct elbowroom_robot_file {
    /* Its name in the model, not that of another robot, without / , ; */
    const char *name;
    /* URDF, 3DS, GLB or glTF. */
    const char *path;
    /* SRDF with disabled pairs, or NULL. */
    const char *srdf;
    /* Joints file of a 3DS, GLB or glTF model, or NULL: MODEL.joints.toml beside it. */
    const char *joints;
    /* Unit of meshes whose format has none: "m", "cm", "mm" or "in"; NULL: "m". */
    const char *unit;
    /* Pose of the root link in the world. */
    elbowroom_pose base_in_world;
} elbowroom_robot_file;

/*
 * An answer about a state. Names live as long as the model or any checker of it, and a link or object has the same
 * pointer in every answer of a model.
 */
typedef struct elbowroom_answer {
    /* 1 on contact, overlap or inside a closed mesh; of elbowroom_checker_within: if the distance is at most the tolerance. */
    int collides;
    /* The finest elbowroom_level that was needed. */
    int level;
    /* 0 on contact; NaN if it was not asked for, or if there is no pair. */
    double distance_m;
    /* The nearest pair, or the pair in contact: robot/link (the link of a single robot) or an object; NULL without a pair. */
    const char *a;
    const char *b;
    /* Witness points on the surfaces of a and b; NaN if there are none. */
    double point_a_m[3];
    double point_b_m[3];
} elbowroom_answer;

/* The version of the library, as "0.1.0". */
const char *elbowroom_version(void);

/* The text of the last call that failed on this thread, until the next one fails; "" before. Never NULL. */
const char *elbowroom_last_error(void);

/* ---- Models ---- */

/*
 * Loads a cell file (docs/cell-file.md). `regions` are names of regions with commas between, or NULL: these count as solid
 * objects, at their poses at the start.
 */
elbowroom_status elbowroom_model_load_cell(const char *path, const char *regions, elbowroom_model **model);

/*
 * Loads one robot (URDF, 3DS, GLB or glTF) named "robot", whose root link is the world. `srdf` and `pairs` (a file of pairs,
 * docs/query.md) may be NULL.
 */
elbowroom_status elbowroom_model_load_robot(const char *path, const char *srdf, const char *pairs, elbowroom_model **model);

/* Loads several robots, each at its base. `pairs` (a file of pairs) may be NULL. */
elbowroom_status elbowroom_model_load_robots(const elbowroom_robot_file *robots, size_t count, const char *pairs,
                                             elbowroom_model **model);

/* Frees a model; NULL is ignored. Its checkers stay valid. */
void elbowroom_model_free(elbowroom_model *model);

/* Warnings of the files: what was accepted and may be a mistake. */
elbowroom_status elbowroom_model_warning_count(const elbowroom_model *model, size_t *count);
elbowroom_status elbowroom_model_warning(const elbowroom_model *model, size_t warning, const char **text);

/* Robots, in the order of the file or array, counted from 0. Names live as long as the model or any checker of it. */
elbowroom_status elbowroom_model_robot_count(const elbowroom_model *model, size_t *count);
elbowroom_status elbowroom_model_robot_name(const elbowroom_model *model, size_t robot, const char **name);
elbowroom_status elbowroom_model_find_robot(const elbowroom_model *model, const char *name, size_t *robot);

/* Independent joints of a robot, in the order of its joint values. Joints that mimic another have no value. */
elbowroom_status elbowroom_model_joint_count(const elbowroom_model *model, size_t robot, size_t *count);
elbowroom_status elbowroom_model_joint_name(const elbowroom_model *model, size_t robot, size_t joint, const char **name);

/* Limits of all joints, -infinity and infinity without one. `count` is the number of joints. */
elbowroom_status elbowroom_model_joint_limits(const elbowroom_model *model, size_t robot, double *lower, double *upper,
                                              size_t count);

/* Joint values at the start: of the cell, or the values within the limits that are nearest to 0. */
elbowroom_status elbowroom_model_start(const elbowroom_model *model, size_t robot, double *q, size_t count);

/* Links of a robot. */
elbowroom_status elbowroom_model_link_count(const elbowroom_model *model, size_t robot, size_t *count);
elbowroom_status elbowroom_model_link_name(const elbowroom_model *model, size_t robot, size_t link, const char **name);
elbowroom_status elbowroom_model_find_link(const elbowroom_model *model, size_t robot, const char *name, size_t *link);

/* Objects of a cell. */
elbowroom_status elbowroom_model_object_count(const elbowroom_model *model, size_t *count);
elbowroom_status elbowroom_model_object_name(const elbowroom_model *model, size_t object, const char **name);

/* ---- Checkers ---- */

/*
 * Makes a checker with all robots at their start. `level` is an elbowroom_level. `between` names pairs, as
 * "left,right;left/link_3,table" (docs/query.md), or is NULL: all pairs. Named pairs that are never tested (two links of one
 * joint, say) are an error. Without any pair, answers say "free" with a NaN distance.
 */
elbowroom_status elbowroom_checker_new(const elbowroom_model *model, int level, const char *between,
                                       elbowroom_checker **checker);

/* Frees a checker; NULL is ignored. */
void elbowroom_checker_free(elbowroom_checker *checker);

/*
 * Forgets what earlier answers taught; joint values stay. A checker learns which pairs are likely to collide. Answers are
 * the same, except which of several pairs in contact is named. `elbowroom query` starts anew after every
 * ELBOWROOM_BLOCK states.
 */
elbowroom_status elbowroom_checker_restart(elbowroom_checker *checker);

/* States after which `elbowroom query` starts anew. */
#define ELBOWROOM_BLOCK 256

/* Moves a robot, with what it carries. Values beyond the limits are accepted. */
elbowroom_status elbowroom_checker_set_q(elbowroom_checker *checker, size_t robot, const double *q, size_t count);

/* Forward kinematics: the pose of a link in the world. */
elbowroom_status elbowroom_checker_link_pose(elbowroom_checker *checker, size_t robot, size_t link, elbowroom_pose *pose);

/* Whether a pair is in contact, and which. */
elbowroom_status elbowroom_checker_collision(elbowroom_checker *checker, elbowroom_answer *answer);

/* The nearest pair, its distance and witness points. */
elbowroom_status elbowroom_checker_distance(elbowroom_checker *checker, elbowroom_answer *answer);

/* Whether a pair is no farther apart than a tolerance; if so, the nearest pair and its distance. */
elbowroom_status elbowroom_checker_within(elbowroom_checker *checker, double tolerance_m, elbowroom_answer *answer);

/*
 * All pairs no farther apart than a margin, the nearest first. `count` is their number, also if more than `capacity`: then the
 * status is ELBOWROOM_TOO_SHORT, and the first `capacity` are written. `answers` may be NULL if `capacity` is 0.
 */
elbowroom_status elbowroom_checker_all_pairs(elbowroom_checker *checker, double margin_m, elbowroom_answer *answers,
                                             size_t capacity, size_t *count);

#ifdef __cplusplus
}
#endif

#endif
