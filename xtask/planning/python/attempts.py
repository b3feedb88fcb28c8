"""One attempt at one problem, as a line of JSON; xtask/planning/README.md has the fields."""

import json
import math
import subprocess


def write(path, attempts):
    with open(path, "w") as out:
        for attempt in attempts:
            out.write(json.dumps(attempt) + "\n")


def read(path):
    with open(path) as text:
        return [json.loads(line) for line in text]


def unsolved(problem, seed, valid, joints=None):
    """What an attempt is before anything is found."""
    return {
        "set": problem.set,
        "id": problem.id,
        "seed": seed,
        "valid": bool(valid),
        "solved": False,
        "joints": joints or problem.joints(),
        "planning_us": 0.0,
        "simplify_us": 0.0,
        "cost_raw": 0.0,
        "cost": 0.0,
        "path": [],
    }


def length(path):
    """The sum of the Euclidean lengths of the steps, radians."""
    return sum(math.dist(a, b) for a, b in zip(path, path[1:]))


def last_words(text):
    """The line of a program's standard error that says why it ended."""
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else "it said nothing"


def call(words):
    """Runs a program that must end well; gives its standard output."""
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"`{words[0]}` ended with exit status {done.returncode}: {last_words(done.stderr)}")
    return done.stdout


def programs(words):
    """Of `LIB=PROGRAM` and `LIB!REASON`: the program of each LIB that can run."""
    return dict(word.split("=", 1) for word in words if "=" in word.split("!", 1)[0])


def left_out(words):
    """Of the same words: a sentence for each LIB that cannot."""
    return ["{} is left out: {}".format(*word.split("!", 1)) for word in words if "=" not in word.split("!", 1)[0]]
