"""An attempt of a planner that shortens its path, and its length at a time."""

# Times at which the length is asked, ms. The last one is the time that each planner has.
TIMES_MS = (1, 10, 100)


def attempt(set, id, seed, valid, joints, path, improvements):
    """`improvements` has time (µs) and length (rad) of each path; those after the last time do not count."""
    within = [[time, cost] for time, cost in improvements if time <= 1000 * TIMES_MS[-1]]
    return {
        "set": set,
        "id": id,
        "seed": seed,
        "valid": valid,
        "solved": bool(within),
        "joints": joints,
        "path": path,
        "improvements": within,
    }


def cost_at(attempt, time_ms):
    """The length of the shortest path by then; None if there is none."""
    costs = [cost for time, cost in attempt["improvements"] if time <= 1000 * time_ms]
    return min(costs, default=None)
