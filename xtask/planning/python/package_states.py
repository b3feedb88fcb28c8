"""The package `elbowroom` of Python, asked about the states and edges of a workload; used if it is installed."""

import importlib.util
import json
import statistics
import time

import numpy as np


def is_there():
    return importlib.util.find_spec("elbowroom") is not None


def scene_of(document, call):
    import elbowroom as er

    scene = er.Scene("workload")
    scene.add_robot("arm", call.urdf, srdf=call.srdf or None)
    for number, obstacle in enumerate(document["obstacles"]):
        if obstacle["type"] == "sphere":
            scene.add_sphere(f"o{number}", obstacle["radius"], obstacle["centre"])
        else:
            w, x, y, z = obstacle["quat_wxyz"]
            size = [2 * half for half in obstacle["half"]]
            scene.add_box(f"o{number}", size, (obstacle["centre"], [x, y, z, w]))
    return scene.cell()


def ask(document, call):
    """Answer as the other programs do; obstacles and the robot with itself, exactly."""
    import elbowroom as er

    cell = scene_of(document, call)
    checker = er.Checker(cell, threads=1)
    joints = [name.removeprefix("arm.") for name in checker.joints]
    given = {name: column for column, name in enumerate(document["joints"])}

    def rows(states):
        values = np.asarray(states, dtype=float)
        fixed = document["fixed"]
        columns = [values[:, given[name]] if name in given else np.full(len(values), fixed[name]) for name in joints]
        return np.ascontiguousarray(np.stack(columns, axis=1))

    states = rows(document["states"])
    states = states[~checker.collides(states)]
    begins, ends = (rows([edge[end] for edge in document["edges"]]) for end in (0, 1))
    free = checker.edges(begins, ends).free
    begins, ends = begins[free], ends[free]
    on_edges = np.ceil(np.linalg.norm(ends - begins, axis=1) * document["states_per_radian"]).sum()
    single = per_call(lambda: checker.collides(states)) / len(states)
    edge = per_call(lambda: checker.edges(begins, ends)) / on_edges
    line = {"lib": "elbowroom.Checker", "obstacles": len(document["obstacles"])}
    return json.dumps(line | {"ns_per_state_edge": edge, "ns_per_state_single": single})


def per_call(call):
    """Nanoseconds of a call, the median of five rounds of at least a tenth of a second."""
    rounds = []
    for _ in range(5):
        calls, begin = 0, time.process_time_ns()
        while time.process_time_ns() - begin < 1e8:
            call()
            calls += 1
        rounds.append((time.process_time_ns() - begin) / calls)
    return statistics.median(rounds)
