"""Lengths after 1, 10 and 100 ms as lines of JSON, and as a table."""

import json

import numpy as np

from anytime_attempts import TIMES_MS, cost_at


def lines(found, hitting):
    """A line per planner, set and time, and over `all` sets.

    `hitting` has the set of each attempt with the first seed, and whether its last path hits something.
    """
    if not found:
        return []
    every = next(iter(found.values()))
    sets = [*dict.fromkeys(attempt["set"] for attempt in every), "all"]
    return [line for name in sets for time_ms in TIMES_MS for line in of_set(found, hitting, name, time_ms)]


def of_set(found, hitting, name, time_ms):
    """The lines of a set. Each planner is compared with the first one, over the attempts that both have solved by then."""
    costs = {lib: costs_of(attempts, name, time_ms) for lib, attempts in found.items()}
    first = next(iter(costs.values()))
    for lib, attempts in found.items():
        own = {key: cost for key, cost in costs[lib].items() if cost is not None}
        common = [key for key in own if first.get(key) is not None]
        chosen = [attempt for attempt in attempts if name in ("all", attempt["set"])]
        yield {
            "lib": lib,
            "set": name,
            "time_ms": time_ms,
            "total": len(chosen),
            "valid": sum(attempt["valid"] for attempt in chosen),
            "solved": len(own),
            "cost": middle([*own.values()]),
            "common": len(common),
            "cost_of_common": middle([own[key] for key in common]),
            "first_cost_of_common": middle([first[key] for key in common]),
            "hits": sum(hits for of, hits in hitting[lib] if name in ("all", of)) if time_ms == TIMES_MS[-1] else None,
        }


def costs_of(attempts, name, time_ms):
    chosen = (attempt for attempt in attempts if name in ("all", attempt["set"]))
    return {(a["set"], a["id"], a["seed"]): cost_at(a, time_ms) for a in chosen}


def middle(costs):
    """Mean and median."""
    return {"mean": round(float(np.mean(costs)), 4), "p50": round(float(np.median(costs)), 4)} if costs else None


HEAD = ("set", "ms", "lib", "solved/valid/total", "own mean/p50", "common", "mean/p50", "of the first", "hits")
WIDTHS = (18, 4, 12, 18, 12, 6, 10, 12, 5)


def table(lines):
    rows = [HEAD, *(row(line) for line in lines)]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(cells, WIDTHS)).rstrip() for cells in rows)


def row(line):
    counts = "/".join(str(line[key]) for key in ("solved", "valid", "total"))
    name = line["set"].replace("_panda", "")
    own, common, first = (costs(line[key]) for key in ("cost", "cost_of_common", "first_cost_of_common"))
    hits = "" if line["hits"] is None else str(line["hits"])
    return (name, str(line["time_ms"]), line["lib"], counts, own, str(line["common"]), common, first, hits)


def costs(spread):
    return "none" if spread is None else f"{spread['mean']:.2f}/{spread['p50']:.2f}"


def text(line):
    return json.dumps(line, ensure_ascii=False)
