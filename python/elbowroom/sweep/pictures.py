"""Pictures of the answers of a sweep: maps of collisions, distances and reach."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from elbowroom.errors import ArgumentError
from elbowroom.sweep.extras import imported
from elbowroom.sweep.placement import Placement
from elbowroom.sweep.states import Grid, Random, Sobol, States, Table, ranges

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from elbowroom.sweep.result import Result

# Places along an axis of a map of states that are not a grid.
_BINS = 48


def draw(result: Result, axes: tuple[str, str] | None) -> Figure:
    """Draw a map over two joints, or over the places of the base."""
    about = result.manifest()["about"]
    if result.rows == 0:
        raise ArgumentError("there is nothing to draw\n  write: a sweep with rows")
    if "base" in about:
        if axes is not None:
            raise ArgumentError("`axes` are joints, and the picture shows places\n  write: picture() without them")
        return _placement(result.placement())
    return _states(result, about, axes)


def _figure() -> tuple[Figure, Any]:
    """Make a figure that no window shows."""
    figure: Figure = imported("matplotlib.figure", "matplotlib").Figure(figsize=(7.0, 5.6), layout="constrained")
    return figure, figure.subplots()


def _placement(found: Placement) -> Figure:
    """Draw the largest share of targets reached at each x and y, with the turn of the best place."""
    figure, plot = _figure()
    xy, places = np.unique(found.bases[:, :2].round(9), axis=0, return_inverse=True)
    best = np.zeros(len(xy))
    np.maximum.at(best, places.ravel(), found.reached / found.targets)
    most = max(100 * best.max(), 1.0)
    drawn = plot.scatter(xy[:, 0], xy[:, 1], c=100 * best, s=_size(len(xy)), marker="s", cmap="viridis", vmin=0, vmax=most)
    figure.colorbar(drawn, label="targets reached without contact, %, in the best turn")
    top = found.best(1)[0]
    x, y = found.bases[top, :2]
    span = max(np.ptp(xy[:, 0]), np.ptp(xy[:, 1]), 0.5)
    if found.reached[top] > 0:
        heading = found.heading_rad(top)
        plot.plot(x, y, "*", color="red", markersize=14)
        plot.arrow(x, y, 0.08 * span * np.cos(heading), 0.08 * span * np.sin(heading), color="red", width=0.006 * span)
    # Room around a single place or a line of places.
    middle, half = 0.5 * (xy.min(axis=0) + xy.max(axis=0)), 0.5 * np.ptp(xy, axis=0) + 0.1 * span
    low, high = middle - np.maximum(half, 0.25 * span), middle + np.maximum(half, 0.25 * span)
    plot.set(xlabel="x of the base, m", ylabel="y of the base, m", aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    plot.set_title(f"best: {found.reached[top]:,} of {found.targets:,} targets from ({x:.2f}, {y:.2f}) m")
    return figure


def _size(count: int) -> float:
    return max(4.0, 60_000.0 / max(count, 1))


def _states(result: Result, about: dict[str, Any], axes: tuple[str, str] | None) -> Figure:
    """Draw the mean distance, or the share of states, over two joints and all values of the others."""
    joints, limits = about["joints"], ranges(np.array(about["limits"]))
    if len(joints) < 2:
        raise ArgumentError("the model has one joint\n  write: a sweep of two joints or more")
    chosen = [_joint(joints, name) for name in axes or (joints[min(1, len(joints) - 1)], joints[min(2, len(joints) - 1)])]
    states = _read(result.manifest()["task"]["states"])
    shape = [states.steps[k] if isinstance(states, Grid) else _BINS for k in chosen]
    low, high = limits[chosen].T
    column, factor, label = _column(result)
    sums, counts = np.zeros(shape), np.zeros(shape)
    for batch in result.batches():
        q = states.rows(int(batch["index"][0]), len(batch["index"]), np.array(about["limits"]))[:, chosen]
        steps = np.array(shape) - isinstance(states, Grid)
        at = np.clip(((q - low) / (high - low) * steps + 0.5 * isinstance(states, Grid)).astype(int), 0, np.array(shape) - 1)
        values = batch[column].astype(float) if column in result.least else (batch[column] != 0).astype(float)
        known = np.isfinite(values)
        place = (at[known, 0], at[known, 1])
        np.add.at(sums, place, values[known])
        np.add.at(counts, place, 1.0)
    figure, plot = _figure()
    values = np.where(counts > 0, factor * sums / np.maximum(counts, 1.0), np.nan)
    drawn = plot.imshow(values.T, origin="lower", aspect="auto", extent=(low[0], high[0], low[1], high[1]), cmap="viridis")
    figure.colorbar(drawn, label=label)
    plot.set(xlabel=f"{joints[chosen[0]]}, rad or m", ylabel=f"{joints[chosen[1]]}, rad or m")
    plot.set_title(f"{result.rows:,} states; the other joints anywhere")
    return figure


def _column(result: Result) -> tuple[str, float, str]:
    """Return the column to draw, the factor to its unit, and what is drawn: distances, else shares, else means."""
    if "distance_m" in result.least:
        return "distance_m", 1e3, "mean distance, mm; contact is 0"
    if result.counts:
        name = next(iter(result.counts))
        return name, 100.0, f"states with `{name}`, %"
    if result.least:
        name = next(iter(result.least))
        return name, 1.0, f"mean of `{name}`"
    raise ArgumentError("no column has numbers\n  write: a sweep with a column of numbers")


def _joint(joints: list[str], name: str) -> int:
    if name not in joints:
        raise ArgumentError(f"there is no joint {name!r}\n  write: one of {', '.join(joints)}")
    return joints.index(name)


def _read(states: dict[str, Any]) -> States:
    """Return the states that a manifest names."""
    kind = states["kind"]
    if kind == "grid":
        return Grid(tuple(states["steps"]))
    if kind == "table":
        return Table(Path(states["file"]))
    return (Random if kind == "random" else Sobol)(states["number"], states["seed"])
