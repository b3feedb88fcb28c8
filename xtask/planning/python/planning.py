"""`cargo xtask planning`: every planner on the same problems, one after the other, and whether its paths hit anything.

usage: planning.py --problems FILE --urdf R [--srdf S] --folder DIR --hits PROGRAM [--json] LIB=PROGRAM… LIB!REASON…
A LIB with a REASON is named and left out. Each planner and seed is a process of its own. SEEDS: how many.
"""

import argparse
import os
import subprocess
import sys
from dataclasses import dataclass

import attempts
import hits
import problems
import report
from solids import Robot

HERE = os.path.dirname(os.path.abspath(__file__))


@dataclass
class Peer:
    lib: str
    mode: str
    script: str
    per_set: int = 0


PEERS = [
    Peer("elbowroom", "meshes", "peer_elbowroom.py"),
    Peer("vamp", "spheres", "peer_vamp.py"),
    Peer("plainmp", "spheres", "peer_plainmp.py"),
    Peer("plainmp+vamp_spheres", "spheres", "peer_plainmp.py"),
    # Its checks run through Python: a part of the problems is enough to see the order of magnitude.
    Peer("ompl", "meshes", "peer_ompl.py", per_set=10),
]


def options(seeds=5):
    words = argparse.ArgumentParser()
    words.add_argument("--problems", required=True)
    words.add_argument("--urdf", required=True)
    words.add_argument("--srdf", default="")
    words.add_argument("--folder", required=True)
    words.add_argument("--hits", required=True, help="the program compiled from cpp/hits.cpp")
    words.add_argument("--json", action="store_true")
    words.add_argument("--seeds", type=int, default=int(os.environ.get("SEEDS", str(seeds))))
    words.add_argument("libs", nargs="*", metavar="LIB=PROGRAM")
    return words.parse_args()


def attempts_of(peer, program, seed, call):
    out = os.path.join(call.folder, f"{peer.lib}_{peer.mode}_{seed}.jsonl")
    words = [sys.executable, "-B", os.path.join(HERE, peer.script), "--problems", call.problems, "--urdf", call.urdf]
    words += ["--srdf", call.srdf, "--folder", call.folder, "--out", out, "--seed", str(seed)]
    words += ["--lib", peer.lib, "--program", program, "--per-set", str(peer.per_set)]
    done = subprocess.run(words, stderr=subprocess.PIPE, text=True, stdout=sys.stderr)
    if done.returncode != 0:
        raise RuntimeError(attempts.last_words(done.stderr))
    return attempts.read(out)


def measure(peer, program, call, robot, by_name):
    found = []
    for seed in range(call.seeds):
        print(f"{peer.lib}, {peer.mode}, seed {seed}", file=sys.stderr)
        found += attempts_of(peer, program, seed, call)
    print(f"{peer.lib}, {peer.mode}: {len(found)} attempts, hits", file=sys.stderr)
    checked = hits.of(call.hits, os.path.join(call.folder, "hits_job.txt"), robot, by_name, found)
    tell_hits(peer, found, checked, call.folder)
    return report.lines(peer.lib, peer.mode, found, checked)


def tell_hits(peer, found, checked, folder):
    """Which path hits what, and where along it (0 to 1), for who wants to look."""
    with open(os.path.join(folder, f"{peer.lib}_{peer.mode}_hits.csv"), "w") as out:
        out.write("set,id,seed,at,a,b,ends_hit\n")
        for attempt, finding in zip(found, checked):
            if finding["hit"]:
                at, (a, b) = finding["hit"]
                ends = "yes" if finding["ends"] else "no"
                out.write(f"{attempt['set']},{attempt['id']},{attempt['seed']},{at:.4f},{a},{b},{ends}\n")


def main():
    call = options()
    programs = attempts.programs(call.libs)
    try:
        robot = Robot(call.urdf, call.srdf)
        by_name = {(problem.set, problem.id): problem for problem in problems.read(call.problems)}
    except (ValueError, KeyError) as reason:
        sys.exit(f"{call.problems} with {call.urdf}: {reason}")
    every, missing = [], attempts.left_out(call.libs)
    for peer in PEERS:
        if peer.lib not in programs:
            continue
        try:
            lines = measure(peer, programs[peer.lib], call, robot, by_name)
        except (RuntimeError, OSError) as reason:
            missing.append(f"{peer.lib} is left out: {reason}")
            print(missing[-1], file=sys.stderr)
            continue
        every += lines
        if call.json:
            print("\n".join(report.text(line) for line in lines), flush=True)
    print("\n".join([report.table(every), *missing]), file=sys.stderr if call.json else sys.stdout)
    return 0 if every else 1


if __name__ == "__main__":
    sys.exit(main())
