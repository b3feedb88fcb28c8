"""The command line that all planners' programs share."""

import argparse
from dataclasses import dataclass

import problems


@dataclass
class Job:
    problems: list
    file: str
    urdf: str
    srdf: str
    seed: int
    lib: str
    out: str
    program: str
    folder: str


def read():
    words = argparse.ArgumentParser()
    words.add_argument("--problems", required=True)
    words.add_argument("--urdf", required=True)
    words.add_argument("--srdf", default="")
    words.add_argument("--seed", type=int, default=0)
    words.add_argument("--lib", default="", help="the planner, where a script has several")
    words.add_argument("--out", required=True, help="the attempts are written here")
    words.add_argument("--program", default="", help="the compiled program, where the planner has one")
    words.add_argument("--folder", default=".", help="for files in between")
    words.add_argument("--per-set", type=int, default=0, help="only so many problems of each set; 0: all")
    call = words.parse_args()
    chosen = first(problems.read(call.problems), call.per_set)
    return Job(chosen, call.problems, call.urdf, call.srdf, call.seed, call.lib, call.out, call.program, call.folder)


def first(every, per_set):
    if per_set == 0:
        return every
    seen, chosen = {}, []
    for problem in every:
        seen[problem.set] = seen.get(problem.set, 0) + 1
        if seen[problem.set] <= per_set:
            chosen.append(problem)
    return chosen
