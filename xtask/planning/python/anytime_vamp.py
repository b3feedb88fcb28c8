"""VAMP's AORRTC and FCIT*: its own spheres and substituted cylinders; a seed skips a thousand states of the Halton sequence."""

import json

import attempts
import job
import vamp_words
from anytime_attempts import TIMES_MS, attempt


def main():
    task = job.read()
    scenes = vamp_words.write(task)
    planner = task.lib.removeprefix("vamp_")
    lines = attempts.call([task.program, scenes, planner, str(TIMES_MS[-1]), str(1000 * task.seed)]).splitlines()
    found = []
    for problem, line in zip(task.problems, map(json.loads, lines)):
        keys = (line["set"], line["id"], task.seed, line["valid"])
        found.append(attempt(*keys, problem.joints(), line["path"], line["improvements"]))
    attempts.write(task.out, found)


if __name__ == "__main__":
    main()
