"""Whether paths hit the true meshes and primitives at one of 10,000 points: the job for `cpp/hits.cpp`."""

import coal

import attempts
from solids import pairs_among

POINTS = 10_000


def of(program, job, robot, by_name, found):
    """For each attempt: where along its path (0 to 1) it first hits and what, and what its problem's ends hit; or None."""
    with open(job, "w") as out:
        out.write("\n".join(robot_lines(robot)) + "\n")
        for attempt in found:
            out.write("\n".join(attempt_lines(robot, by_name[attempt["set"], attempt["id"]], attempt)) + "\n")
    answers = iter(attempts.call([program, job, str(POINTS)]).splitlines())
    findings = []
    for attempt in found:
        names = names_in(robot, by_name[attempt["set"], attempt["id"]])
        ends = [finding(next(answers), names) for _ in range(2)]
        path = finding(next(answers), names) if attempt["solved"] else None
        findings.append({"hit": path, "ends": ends[0] or ends[1]})
    return findings


def finding(answer, names):
    words = answer.split()
    return None if words[0] == "free" else (float(words[1]), (names[int(words[2])], names[int(words[3])]))


def names_in(robot, problem):
    return robot.links + [solid.name for solid in problem.solids]


def robot_lines(robot):
    model, out = robot.model, []
    reach = robot.reach()
    for i in range(1, model.njoints):
        kind, axis = robot.motion(i)
        placement = model.jointPlacements[i].homogeneous
        out.append(words("joint", model.parents[i], kind, *axis, *rows(placement), reach[i]))
    for body in robot.shapes.geometryObjects:
        out.append(words("body", body.parentJoint, *rows(body.placement.homogeneous), *shape_words(body.geometry)))
    return out


def shape_words(shape):
    if isinstance(shape, coal.Box):
        return ["box", *(2 * x for x in shape.halfSide)]
    if isinstance(shape, coal.Sphere):
        return ["sphere", shape.radius]
    if isinstance(shape, coal.Cylinder):
        return ["cylinder", shape.radius, 2 * shape.halfLength]
    if isinstance(shape, coal.Capsule):
        return ["capsule", shape.radius, 2 * shape.halfLength]
    corners = [x for k in range(shape.num_vertices) for x in shape.vertices(k)]
    triangles = [i for k in range(shape.num_tris) for i in (shape.tri_indices(k)[c] for c in range(3))]
    return ["mesh", shape.num_vertices, shape.num_tris, *corners, *triangles]


def attempt_lines(robot, problem, attempt):
    names = names_in(robot, problem)
    out = ["cell"]
    out += [words("body", 0, *rows(solid.pose), solid.kind, *solid.sizes) for solid in problem.solids]
    out += [words("pair", a, b) for a, b in pairs_among(robot, names, problem.allowed)]
    for end in ({}, problem.goal):
        out += path_lines([robot.values(problem.start, end)])
    if attempt["solved"]:
        out += path_lines(states(robot, problem, attempt))
    return out


def states(robot, problem, attempt):
    """Pinocchio's configurations; joints that the path lacks (the fingers) stay as in the problem's start, whatever it is."""
    return [robot.values(problem.start, dict(zip(attempt["joints"], state))) for state in attempt["path"]]


def path_lines(configurations):
    return [f"path {len(configurations)}", *(words(*q) for q in configurations)]


def rows(matrix):
    return matrix[:3].ravel()


def words(*parts):
    return " ".join(part if isinstance(part, str) else repr(part.item() if hasattr(part, "item") else part) for part in parts)
