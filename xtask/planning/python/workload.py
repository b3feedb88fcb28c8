"""Random scenes for timing single states: spheres and boxes around a Panda, and edges that are free among them.

Obstacles are spread evenly over a ball of 1.3 m about the base and get smaller as they get more; those that come near the
arm anywhere on an edge are drawn again. So every test has to be carried to its end, whatever the robot is made of.
"""

import json

import numpy as np

from problems import Solid, rotation
from solids import Cell, Robot

JOINTS = [f"panda_joint{k}" for k in range(1, 8)]
FINGERS = {"panda_finger_joint1": 0.035, "panda_finger_joint2": 0.035}
EDGES, PER_RADIAN = 64, 32
# Multiples of 16 states at 32 per radian, less what rounding could add: nobody's block is partly empty.
LENGTHS = (0.5, 1.0, 1.5)
CELL, MARGIN = 0.03, 3
HALF = 1.5


def write(path, urdf, srdf, count, seed=1):
    random, robot = np.random.default_rng(seed), Robot(urdf, srdf)
    if any(name not in robot.index for name in JOINTS):
        raise SystemExit(f"{urdf}: the scenes are made for the Panda, whose joints are {', '.join(JOINTS)}")
    edges = free_edges(robot, random)
    taken = swept(robot, edges)
    obstacles = [obstacle(random, taken, count) for _ in range(count)]
    edges = [edge for edge in edges if free(Cell(robot, [solid(o) for o in obstacles]), robot, edge)]
    states = [q.tolist() for edge in edges for q in spread(edge, 5)]
    random.shuffle(states)
    document = {"joints": JOINTS, "fixed": FINGERS, "states_per_radian": PER_RADIAN}
    document |= {"obstacles": obstacles, "edges": edges, "states": states}
    with open(path, "w") as out:
        json.dump(document, out)
    return document


def free_edges(robot, random):
    """In front of the base; free of self-collision."""
    at = [robot.index[name] for name in JOINTS]
    low, high = robot.model.lowerPositionLimit[at].copy(), robot.model.upperPositionLimit[at].copy()
    low[0], high[0] = -0.8, 0.8
    alone, edges = Cell(robot, []), []
    while len(edges) < EDGES:
        start, towards = random.uniform(low, high), random.normal(size=7)
        goal = start + towards / np.linalg.norm(towards) * (LENGTHS[len(edges) % 3] - 1e-4)
        edge = [start.tolist(), goal.tolist()]
        if np.all(goal >= low) and np.all(goal <= high) and free(alone, robot, edge):
            edges.append(edge)
    return edges


def along(robot, edge):
    count = int(np.ceil(np.linalg.norm(np.subtract(*edge)) * PER_RADIAN)) + 1
    return [robot.values(FINGERS, dict(zip(JOINTS, q))) for q in spread(edge, count)]


def spread(edge, count):
    return np.linspace(edge[0], edge[1], count)


def free(cell, robot, edge):
    return all(cell.collides(q) is None for q in along(robot, edge))


def swept(robot, edges):
    """The cells of a grid that are near the arm somewhere on an edge."""
    size = int(2 * HALF / CELL)
    grid, cell = np.zeros((size,) * 3, dtype=bool), Cell(robot, [])
    points = [surface(body.geometry) for body in robot.shapes.geometryObjects]
    for edge in edges:
        for q in along(robot, edge):
            cell.place(q)
            for link, own in enumerate(points):
                world = own @ cell.rotations[link].T + cell.shifts[link]
                at = np.clip(((world + HALF) / CELL).astype(int), 0, size - 1)
                grid[tuple(at.T)] = True
    for axis in range(3):
        grid = np.any([np.roll(grid, k, axis) for k in range(-MARGIN, MARGIN + 1)], axis=0)
    return grid


def surface(mesh):
    """Corners, and the middles of edges and triangles."""
    corners = np.array([mesh.vertices(k) for k in range(mesh.num_vertices)])
    rows = np.array([[t[0], t[1], t[2]] for t in (mesh.tri_indices(k) for k in range(mesh.num_tris))])
    a, b, c = (corners[rows[:, k]] for k in range(3))
    return np.concatenate([corners, (a + b) / 2, (b + c) / 2, (c + a) / 2, (a + b + c) / 3])


def obstacle(random, taken, count):
    largest = 0.2 * (10 / count) ** (1 / 3)
    while True:
        centre = random.normal(size=3)
        centre *= 1.3 * random.uniform() ** (1 / 3) / np.linalg.norm(centre)
        half = random.uniform(0.3 * largest, largest, size=3)
        reach = np.linalg.norm(half)
        low, high = (((centre + side * reach + HALF) / CELL).astype(int) for side in (-1, 1))
        if not taken[tuple(slice(max(a, 0), max(b, 0) + 1) for a, b in zip(low, high))].any():
            break
    if random.uniform() < 0.5:
        return {"type": "sphere", "centre": centre.tolist(), "radius": float(half[0])}
    turn = random.normal(size=4)
    turn /= np.linalg.norm(turn)
    return {"type": "box", "centre": centre.tolist(), "half": half.tolist(), "quat_wxyz": turn.tolist()}


def solid(obstacle):
    pose = np.eye(4)
    pose[:3, 3] = obstacle["centre"]
    if obstacle["type"] == "sphere":
        return Solid("obstacle", "sphere", [obstacle["radius"]], pose)
    pose[:3, :3] = rotation(np.roll(obstacle["quat_wxyz"], -1))
    return Solid("obstacle", "box", [2 * x for x in obstacle["half"]], pose)
