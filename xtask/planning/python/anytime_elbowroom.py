"""elbowroom: `plan --optimize` on the problem file as it is, true meshes and true cylinders."""

import os
import shutil

import attempts
import job
from anytime_attempts import TIMES_MS, attempt
from peer_elbowroom import answers, path_of


def record(answer, paths, seed):
    joints, path = [], []
    if answer["found"]:
        joints, path = path_of(os.path.join(paths, f"{answer['set']}-{answer['id']}.csv"))
    improvements = [(entry["time_us"], entry["cost_rad"]) for entry in answer["improvements"]]
    return attempt(answer["set"], answer["id"], seed, answer["valid"], joints, path, improvements)


def main():
    task = job.read()
    paths = os.path.join(task.folder, "elbowroom_anytime_paths")
    shutil.rmtree(paths, ignore_errors=True)
    os.makedirs(paths)
    found = answers(task, paths, ["--optimize", "--time-limit", repr(TIMES_MS[-1] / 1000)])
    attempts.write(task.out, [record(answer, paths, task.seed) for answer in found])


if __name__ == "__main__":
    main()
