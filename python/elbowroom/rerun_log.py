"""Logging to Rerun: the scene of a cell, and what moves in it. It needs the package `rerun-sdk`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError
from elbowroom.optional import imported
from elbowroom.trajectory import Trajectory

if TYPE_CHECKING:
    from elbowroom._elbowroom import Cell
    from elbowroom.results import Run

__all__ = ["log_cell", "log_run"]

#: The timeline, in seconds since the motion began.
_TIMELINE = "time_s"


def log_cell(cell: Cell, motions: Mapping[str, Trajectory] | None = None, stream: Any = None) -> None:
    """Log a cell; robots with a trajectory move, the others stay at their start."""
    rerun = imported("rerun")
    given: Mapping[str, Any] = {} if motions is None else motions
    if not isinstance(given, Mapping):
        raise ArgumentError(f'`motions` is a {type(given).__name__}\n  write: {{"robot": trajectory}}')
    _log_meshes(rerun, cell, stream)
    wrong = [name for name, motion in given.items() if not isinstance(motion, Trajectory)]
    if wrong:
        raise ArgumentError(f'the motion of "{wrong[0]}" is a {type(given[wrong[0]]).__name__}\n  write: a Trajectory')
    columns = {name: cell.columns(name) for name in given}
    ordered = {name: motion.ordered(cell.joints_of(name)) for name, motion in given.items()}
    times = np.unique(np.concatenate([[0.0], *(motion.times_s for motion in ordered.values())]))
    states = np.repeat(cell.start[None, :], len(times), axis=0)
    for name, motion in ordered.items():
        states[:, columns[name]] = motion.at(times)
    _log_poses(rerun, cell.fk(states), times, stream)


def log_run(run: Run, stream: Any = None) -> None:
    """Log the cell of a run with all that moves, and the overrides."""
    rerun = imported("rerun")
    _log_meshes(rerun, run.cell, stream)
    traces = [run.trace(robot) for robot in run.cell.robots]
    times = traces[0].times_s if traces else np.zeros(1)
    if traces:
        _log_poses(rerun, run.cell.fk(np.hstack([trace.q for trace in traces])), times, stream)
    _log_poses(rerun, run.objects, times, stream)
    for trace in traces:
        scalars = rerun.Scalars.columns(scalars=trace.speed_override)
        rerun.send_columns(f"speed_override/{trace.robot}", _at(rerun, times), scalars, recording=stream)


def _log_meshes(rerun: Any, cell: Cell, stream: Any) -> None:
    places = {name: of[0] for name, of in cell.fk(cell.start[None, :]).items()} | cell.objects
    for name, mesh in cell.meshes().items():
        triangles = rerun.Mesh3D(vertex_positions=mesh.vertices, triangle_indices=mesh.faces)
        rerun.log(f"cell/{name}/mesh", triangles, static=True, recording=stream)
    # Rows of time 0, and nothing static, which would hide where it is later.
    _log_poses(rerun, {name: of[None] for name, of in places.items()}, np.zeros(1), stream)


def _log_poses(rerun: Any, poses: Mapping[str, npt.NDArray[np.float64]], times: npt.NDArray[np.float64], stream: Any) -> None:
    for name, of in poses.items():
        columns = rerun.Transform3D.columns(translation=of[:, :3, 3], mat3x3=of[:, :3, :3].reshape(-1, 9))
        rerun.send_columns(f"cell/{name}", _at(rerun, times), columns, recording=stream)


def _at(rerun: Any, times: npt.NDArray[np.float64]) -> Any:
    return [rerun.TimeColumn(_TIMELINE, duration=times)]
