"""`cargo xtask planning --anytime`: the length of the best path after 1, 10 and 100 ms, of planners that shorten it.

usage: anytime.py --problems FILE --urdf R [--srdf S] --folder DIR --hits PROGRAM [--json] LIB=PROGRAM… LIB!REASON…
A LIB with a REASON is named and left out. Each planner and seed is a process of its own. SEEDS: how many.
"""

import os
import sys

import anytime_report
import attempts
import hits
import planning
import problems
from planning import Peer
from solids import Robot

PEERS = [
    Peer("elbowroom", "meshes", "anytime_elbowroom.py"),
    Peer("vamp_aorrtc", "spheres", "anytime_vamp.py"),
    # It is run again and again with more batches, some ten times as long as the others.
    Peer("vamp_fcit", "spheres", "anytime_vamp.py", per_set=6),
]


def main():
    call = planning.options(seeds=2)
    programs, missing = attempts.programs(call.libs), attempts.left_out(call.libs)
    robot = Robot(call.urdf, call.srdf)
    by_name = {(problem.set, problem.id): problem for problem in problems.read(call.problems)}
    found, hitting = {}, {}
    for peer in (peer for peer in PEERS if peer.lib in programs):
        try:
            every = []
            for seed in range(call.seeds):
                print(f"{peer.lib}, seed {seed}", file=sys.stderr)
                every += planning.attempts_of(peer, programs[peer.lib], seed, call)
            # The check takes longer than planning: one seed is enough to tell.
            first = [attempt for attempt in every if attempt["seed"] == 0]
            checked = hits.of(call.hits, os.path.join(call.folder, "hits_job.txt"), robot, by_name, first)
        except (RuntimeError, OSError) as reason:
            missing.append(f"{peer.lib} is left out: {reason}")
            continue
        found[peer.lib] = every
        hitting[peer.lib] = [(attempt["set"], finding["hit"] is not None) for attempt, finding in zip(first, checked)]
    lines = anytime_report.lines(found, hitting)
    if call.json:
        print("\n".join(map(anytime_report.text, lines)))
    print("\n".join([anytime_report.table(lines), *missing]), file=sys.stderr if call.json else sys.stdout)
    return 0 if lines else 1


if __name__ == "__main__":
    sys.exit(main())
