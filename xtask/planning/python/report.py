"""Attempts as lines of JSON, and as a table."""

import json

import numpy as np

KEYS = ("planning_us", "simplify_us")


def lines(lib, mode, attempts, hits):
    """A line per set and one over `all`. `hits` has for each attempt what its path and the ends of its problem hit."""
    sets = list(dict.fromkeys(attempt["set"] for attempt in attempts))
    out = [line(lib, name, mode, [(a, h) for a, h in zip(attempts, hits) if a["set"] == name]) for name in sets]
    return out + [line(lib, "all", mode, list(zip(attempts, hits)))]


def line(lib, name, mode, checked):
    solved = [attempt for attempt, _ in checked if attempt["solved"]]
    out = {
        "lib": lib,
        "set": name,
        "mode": mode,
        "total": len(checked),
        "valid": sum(attempt["valid"] for attempt, _ in checked),
        "solved": len(solved),
    }
    for key in KEYS:
        out[key] = spread([attempt[key] for attempt in solved])
    for key in ("cost_raw", "cost"):
        out[key] = round(float(np.mean([attempt[key] for attempt in solved])), 4) if solved else None
    out["hits"] = sum(finding["hit"] is not None for _, finding in checked)
    out["hits_at_ends"] = sum(finding["hit"] is not None and finding["ends"] is not None for _, finding in checked)
    return out


def spread(values):
    if not values:
        return {"p50": None, "mean": None, "p95": None}
    p50, p95 = np.percentile(values, [50, 95])
    return {"p50": round(float(p50), 2), "mean": round(float(np.mean(values)), 2), "p95": round(float(p95), 2)}


HEAD = ("lib", "set", "mode", "solved/valid/total", "planning µs p50/mean/p95", "simplify µs p50/mean/p95", "cost", "hits")
WIDTHS = (26, 16, 8, 18, 24, 24, 14, 12)


def table(lines):
    rows = [HEAD, *(row(line) for line in lines)]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(cells, WIDTHS)).rstrip() for cells in rows)


def row(line):
    counts = "/".join(str(line[key]) for key in ("solved", "valid", "total"))
    cost = "none" if line["cost"] is None else f"{line['cost_raw']:.2f} > {line['cost']:.2f}"
    name = line["set"].replace("_panda", "")
    return (line["lib"], name, line["mode"], counts, *(times(line[key]) for key in KEYS), cost, hits(line))


def times(spread):
    return "none" if spread["p50"] is None else "/".join(f"{spread[key]:.0f}" for key in ("p50", "mean", "p95"))


def hits(line):
    return f"{line['hits']} of {line['solved']}"


def text(line):
    return json.dumps(line, ensure_ascii=False)
