"""elbowroom: its own program on the problem file as it is, true meshes and true cylinders."""

import csv
import json
import os
import shutil
import subprocess
import sys

import attempts
import job


def answers(task, paths, more=()):
    words = [task.program, "plan", "--urdf", task.urdf, "--problems", task.file, "--json", "--paths", paths]
    words += ["--seed", str(task.seed)] + (["--srdf", task.srdf] if task.srdf else [])
    words += more
    try:
        done = subprocess.run(words, capture_output=True, text=True)
    except OSError as reason:
        sys.exit(f"{task.program}: {reason.strerror}")
    # 1 says that a problem was not solved.
    if done.returncode in (0, 1):
        try:
            return json.loads(done.stdout)["problems"]
        except (ValueError, KeyError):
            pass
    sys.exit(f"`elbowroom plan --problems` gave no answer (exit status {done.returncode}): {attempts.last_words(done.stderr)}")


def path_of(file):
    """Joint names and states of a timed path, without its times."""
    with open(file) as text:
        rows = list(csv.reader(text))
    keep = [k for k, name in enumerate(rows[0]) if name != "t_s"]
    return [rows[0][k] for k in keep], [[float(row[k]) for k in keep] for row in rows[1:]]


def record(answer, paths, seed):
    joints, path = [], []
    if answer["found"]:
        joints, path = path_of(os.path.join(paths, f"{answer['set']}-{answer['id']}.csv"))
    return {
        "set": answer["set"],
        "id": answer["id"],
        "seed": seed,
        "valid": answer["valid"],
        "solved": answer["found"],
        "joints": joints,
        "planning_us": answer["planning_us"] or 0.0,
        "simplify_us": answer["simplify_us"] or 0.0,
        "cost_raw": answer["cost_raw_rad"] or 0.0,
        "cost": answer["cost_rad"] or 0.0,
        "path": path,
    }


def main():
    task = job.read()
    paths = os.path.join(task.folder, "elbowroom_paths")
    shutil.rmtree(paths, ignore_errors=True)
    os.makedirs(paths)
    chosen = {(problem.set, problem.id) for problem in task.problems}
    found = [answer for answer in answers(task, paths) if (answer["set"], answer["id"]) in chosen]
    attempts.write(task.out, [record(answer, paths, task.seed) for answer in found])


if __name__ == "__main__":
    main()
