"""VAMP: its own spheres and substituted cylinders; a seed skips a thousand states of the Halton sequence."""

import json
import os
import sys

import attempts
import job
import vamp_words

# scripts/evaluate_mbm.py sets a million; the time that VAMP reports is the same with its default of 100,000, the time
# that a caller waits is 0.15 ms shorter.
ITERATIONS = 100_000


def main():
    task = job.read()
    if any(name != f"panda_joint{k}" for p in task.problems for k, name in enumerate(p.joints(), 1)):
        sys.exit("VAMP has compiled code for a few robots; the Panda is the one used here")
    scenes = os.path.join(task.folder, "vamp_problems.txt")
    with open(scenes, "w") as out:
        for problem in task.problems:
            out.write("\n".join(vamp_words.lines(problem)) + "\n")
    lines = attempts.call([task.program, scenes, str(ITERATIONS), str(1000 * task.seed)]).splitlines()
    found = [json.loads(line) for line in lines]
    for problem, attempt in zip(task.problems, found):
        attempt["seed"], attempt["joints"] = task.seed, problem.joints()
    attempts.write(task.out, found)


if __name__ == "__main__":
    main()
