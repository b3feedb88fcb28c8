"""`cargo xtask planning --validity`: how long it takes to say that a state is free, on the same scenes.

usage: validity.py --urdf R [--srdf S] --folder DIR [--json] LIB=PROGRAM… LIB!REASON…
"""

import argparse
import json
import os
import sys

import attempts
import package_states
import vamp_words
import workload

OBSTACLES = (10, 100, 1000)


def options():
    words = argparse.ArgumentParser()
    words.add_argument("--urdf", required=True)
    words.add_argument("--srdf", default="")
    words.add_argument("--folder", required=True)
    words.add_argument("--json", action="store_true")
    words.add_argument("libs", nargs="*", metavar="LIB=PROGRAM")
    return words.parse_args()


def vamp_lines(document):
    out = [f"obstacles {len(document['obstacles'])}"]
    out += [vamp_words.solid_line(workload.solid(obstacle), False) for obstacle in document["obstacles"]]
    out += [vamp_words.words("edge", [*start, *goal]) for start, goal in document["edges"]]
    return out + [vamp_words.words("state", state) for state in document["states"]]


def ask_vamp(program, path, document, call):
    text = path.replace(".json", ".txt")
    with open(text, "w") as out:
        out.write("\n".join(vamp_lines(document)) + "\n")
    return attempts.call([program, text])


def ask_elbowroom(program, path, document, call):
    return attempts.call([program, path, call.urdf, *([call.srdf] if call.srdf else [])])


ASK = {"vamp": ask_vamp, "elbowroom": ask_elbowroom}


def main():
    call = options()
    programs, missing = attempts.programs(call.libs), attempts.left_out(call.libs)
    if not call.json:
        print("lib              obstacles  ns per state: edge  single")
    for count in OBSTACLES:
        path = os.path.join(call.folder, f"validity_{count}.json")
        document = workload.write(path, call.urdf, call.srdf, count)
        for lib in list(programs):
            try:
                answers = ASK[lib](programs[lib], path, document, call).splitlines()
            except (RuntimeError, OSError) as reason:
                missing.append(f"{lib} is left out: {reason}")
                del programs[lib]
                continue
            for line in map(json.loads, answers):
                show(line, call.json)
        if package_states.is_there():
            show(json.loads(package_states.ask(document, call)), call.json)
    print("\n".join(missing), file=sys.stderr if call.json else sys.stdout)


def show(line, as_json):
    if as_json:
        print(json.dumps(line), flush=True)
    else:
        edge, single = line["ns_per_state_edge"], line["ns_per_state_single"]
        print(f"{line['lib']:16} {line['obstacles']:9}  {edge:18.0f}  {single:6.0f}")


if __name__ == "__main__":
    main()
