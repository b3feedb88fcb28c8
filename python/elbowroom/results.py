"""Results: small constant objects; the units are in the names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as _File
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from elbowroom.errors import ArgumentError
from elbowroom.files import written
from elbowroom.pages import frame
from elbowroom.poses import PoseLike
from elbowroom.rerun_log import log_run
from elbowroom.trajectory import Trajectory

if TYPE_CHECKING:
    from elbowroom._elbowroom import Cell, MapRecord, PathRecord, RunRecord

__all__ = [
    "Cooperation",
    "CooperationStep",
    "Edges",
    "Guidance",
    "GuidedStep",
    "JointMap",
    "Mesh",
    "Overrides",
    "Path",
    "Reach",
    "Run",
    "Tick",
    "Trace",
    "Witness",
]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of a surface.

    Attributes
    ----------
    vertices
        `(V, 3)`, metres.
    faces
        `(F, 3)` uint32: indices of vertices, counter-clockwise seen from outside.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class Witness:
    """The nearest pair of every state, and its nearest points.

    Attributes
    ----------
    distance_m
        `(N,)`: the distance; 0 on contact; infinite if there is no pair.
    a, b
        The names of the pair, `robot/link` or an object; `None` without a pair.
    point_a_m, point_b_m
        `(N, 3)`: the nearest points in the world; NaN where they are not known.
    """

    distance_m: npt.NDArray[np.float64]
    a: list[str | None]
    b: list[str | None]
    point_a_m: npt.NDArray[np.float64]
    point_b_m: npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Edges:
    """How far straight motions are free.

    Attributes
    ----------
    free
        `(N,)` bool: proven free from end to end.
    free_share
        `(N,)`: the part of the motion that is free, 0 to 1.
    certain
        `(N,)` bool: false where the proof ended without a contact; what follows `free_share` is unknown.
    a, b
        The names of the pair that meets, `robot/link` or an object; `None` for free motions.
    """

    free: npt.NDArray[np.bool_]
    free_share: npt.NDArray[np.float64]
    certain: npt.NDArray[np.bool_]
    a: list[str | None]
    b: list[str | None]


@dataclass(frozen=True, eq=False)
class Path:
    """A planned path, and its motion over time. In a notebook the robot moves along it in the scene of its cell.

    Attributes
    ----------
    found
        Whether there is a path; all arrays are empty without one.
    reason
        Why there is none.
    robot, joints
        The robot and the names of its joints, in the order of the values.
    waypoints
        `(K, dof)`, rad or m: corners of the path, straight in joint space between them.
    times_s
        `(N,)`: the time of each row of `q`.
    q
        `(N, dof)`, rad or m: linear between the rows.
    cost_rad
        Length in joint space, a metre counting as a radian; `None` without a path.
    planning_us
        Time of the search and of shortening, in microseconds.
    """

    found: bool
    reason: str | None
    robot: str
    joints: list[str]
    waypoints: npt.NDArray[np.float64]
    times_s: npt.NDArray[np.float64]
    q: npt.NDArray[np.float64]
    cost_rad: float | None
    planning_us: int
    _record: PathRecord | None = field(repr=False)

    def __bool__(self) -> bool:
        return self.found

    def __getstate__(self) -> dict[str, Any]:
        """Leave the cell out of copies and pickles."""
        return self.__dict__ | {"_record": None}

    def page(self) -> str:
        """Return the robot on its path as an HTML page that needs no network; not of a copy."""
        if self._record is None:
            raise ArgumentError("a copied path has no cell, so it has no page\n  write: the path that `Planner.plan` returned")
        return self._record.page()

    def _repr_html_(self) -> str:
        return frame(self.page())

    @property
    def duration_s(self) -> float:
        """Duration of the motion."""
        return float(self.times_s[-1]) if len(self.times_s) else 0.0

    @property
    def trajectory(self) -> Trajectory:
        """The motion; `ArrayError` if no path was found."""
        return Trajectory(self.times_s, self.q, self.joints)


@dataclass(frozen=True, eq=False)
class Reach:
    """How a robot reaches each target.

    Attributes
    ----------
    solutions
        `(N,)` uint16: number of joint states within the limits that bring the tool there; 0: out of reach.
    free
        `(N,)` uint16: number of those in which the robot touches nothing.
    q
        `(N, dof)`, rad or m: of these the nearest to the state at the start; NaN without one.
    """

    solutions: npt.NDArray[np.uint16]
    free: npt.NDArray[np.uint16]
    q: npt.NDArray[np.float64]


@dataclass(frozen=True)
class Tick:
    """What the monitor of a robot answers in a tick.

    Attributes
    ----------
    robot
        The robot.
    speed_override
        The override to apply, 0 to 1.
    reason
        Why it has this value, with the names of regions and joints.
    is_fault
        Whether a fault stops the robot, such as a state that is not finite.
    region, distance_m
        The region that limits the override, and how far the robot is from it; `None` without one.
    events
        What happened: the region or `None`, and `warn_in`, `inside_in`, `granted`, … as in `events.csv`.
    """

    robot: str
    speed_override: float
    reason: str
    is_fault: bool
    region: str | None
    distance_m: float | None
    events: tuple[tuple[str | None, str], ...]

    @classmethod
    def _by_robot(cls, ticks: list[tuple[Any, ...]]) -> dict[str, Tick]:
        return {
            robot: cls(robot, factor, reason, is_fault, region, distance_m, tuple(events))
            for robot, (factor, reason, is_fault), region, distance_m, events in ticks
        }


@dataclass(frozen=True, eq=False)
class Overrides:
    """What the monitors answer along a motion.

    Attributes
    ----------
    robots
        The robots, a column each.
    times_s
        `(N,)`: the times of the rows.
    speed_override
        `(N, robots)`: the overrides, 0 to 1.
    reason
        Per row a list with the reason of each robot.
    events
        Time, robot, region or `None`, and what happened.
    """

    robots: list[str]
    times_s: npt.NDArray[np.float64]
    speed_override: npt.NDArray[np.float64]
    reason: list[list[str]]
    events: list[tuple[float, str, str | None, str]]

    @classmethod
    def _of(
        cls,
        robots: list[str],
        times_s: npt.NDArray[np.float64],
        speed_override: npt.NDArray[np.float64],
        reasons: list[str],
        events: list[tuple[float, str, str | None, str]],
    ) -> Overrides:
        # A cell of mechanisms has no column.
        width = max(len(robots), 1)
        rows = [reasons[at : at + width] for at in range(0, len(reasons), width)]
        return cls(robots, times_s, speed_override, rows, events)


@dataclass(frozen=True, eq=False)
class Trace:
    """Every tick of a robot in a run.

    Attributes
    ----------
    robot, joints
        The robot and the names of its joints, in the order of the values.
    times_s
        `(N,)`: seconds since the run began.
    q
        `(N, dof)`, rad or m.
    qd
        `(N, dof)`, rad/s or m/s: joint velocities, as the monitor was told.
    intent
        `(N, dof)`, rad/s or m/s: joint velocities that the program wants at override 1.
    tcp_m
        `(N, 3)`: the tool centre point in the world.
    speed_override
        `(N,)`: 0 to 1.
    distance_m
        `(N,)`: the distance from the governing region; NaN without one.
    """

    robot: str
    joints: list[str]
    times_s: npt.NDArray[np.float64]
    q: npt.NDArray[np.float64]
    qd: npt.NDArray[np.float64]
    intent: npt.NDArray[np.float64]
    tcp_m: npt.NDArray[np.float64]
    speed_override: npt.NDArray[np.float64]
    distance_m: npt.NDArray[np.float64]

    @property
    def trajectory(self) -> Trajectory:
        """The motion."""
        return Trajectory(self.times_s, self.q, self.joints)


@dataclass(frozen=True, eq=False)
class Run:
    """A simulated run of the programs of a cell. In a notebook it shows its report.

    Attributes
    ----------
    summary
        The document of `elbowroom run --json`.
    has_violation
        Whether a robot collided, entered a forbidden region or was in a deadlock.
    notes
        Warnings.
    cell
        The cell.
    """

    summary: dict[str, Any]
    has_violation: bool
    notes: list[str]
    cell: Cell = field(repr=False)
    _record: RunRecord = field(repr=False)

    @property
    def objects(self) -> dict[str, npt.NDArray[np.float64]]:
        """The poses in the world of each object that moves or is gripped: an array `(N, 4, 4)` with a row per tick, metres."""
        return self._record.objects()

    def to_rerun(self, stream: Any = None) -> None:
        """Log the scene with all that moves, and the overrides, to Rerun; `stream` is a `rerun.RecordingStream`."""
        log_run(self, stream)

    def page(self) -> str:
        """Return the report, an HTML page with the scene in 3-D that needs no network."""
        return self._record.page()

    def report(self, file: str | _File | None = None) -> str:
        """Return the report, and write it to a file."""
        page = self.page()
        if file is not None:
            written(_File(file), page)
        return page

    def trace(self, robot: str | None = None) -> Trace:
        """Return every tick of a robot; its name is optional if there is only one."""
        robots = self._record.robots
        if robot is None and len(robots) != 1:
            raise ArgumentError(f"the cell has {len(robots)} robots\n  write: one of {', '.join(robots)}")
        return self._record.trace(robots[0] if robot is None else robot)

    def _repr_html_(self) -> str:
        return frame(self.page())


@dataclass(frozen=True, eq=False)
class GuidedStep:
    """What a guided arm did in a step.

    Attributes
    ----------
    q
        `(dof,)`, rad or m: the joint values after the step.
    tool
        `(4, 4)`: the tool centre point in the world, metres.
    gap_m
        The distance between tool and surfaces at the start of the step; NaN if none is near.
    limit
        What kept the arm from following the hand: `"surface"`, `"entry"`, `"reach"`, `"joint speed"`, `"contact"`, `"energy"`,
        `"unproven"`, `"pose"` (not finite), `"tick too long"` or `"distance unknown"`; `None` if it followed.
    limited_by
        The joint that is too slow, or the part that would be touched; otherwise `None`.
    force_n
        `(3,)`: the force that the hand feels, world axes; NaN without forces in the cell.
    """

    q: npt.NDArray[np.float64]
    tool: npt.NDArray[np.float64]
    gap_m: float
    limit: str | None
    limited_by: str | None
    force_n: npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Guidance:
    """What a guided arm did in many steps: a row for each, with the meaning that `GuidedStep` says.

    Attributes
    ----------
    joints
        The names of the joints, in the order of the values.
    q
        `(N, dof)`, rad or m.
    tool
        `(N, 4, 4)`, metres.
    gap_m
        `(N,)`.
    limit, limited_by
        A word or `None` per step.
    force_n
        `(N, 3)`.
    """

    joints: list[str]
    q: npt.NDArray[np.float64]
    tool: npt.NDArray[np.float64]
    gap_m: npt.NDArray[np.float64]
    limit: list[str | None]
    limited_by: list[str | None]
    force_n: npt.NDArray[np.float64]

    def _only(self) -> GuidedStep:
        return GuidedStep(self.q[0], self.tool[0], float(self.gap_m[0]), self.limit[0], self.limited_by[0], self.force_n[0])


@dataclass(frozen=True, eq=False)
class CooperationStep:
    """What arms that act as one did in a step.

    Attributes
    ----------
    q
        `(joints,)`, rad or m: the joint values of all arms after the step.
    part
        `(4, 4)`: the work-piece in the world, metres.
    holder
        The robot that holds it.
    rate
        The share of the desired speed, 0 to 1.
    hold
        Why it stands although it should move; `None` if it does not.
    handed_over
        Why it was handed over, in the step in which the receiver takes it; otherwise `None`.
    gap_m
        The least distance between two of the arms, with the work-piece; infinite from 0.1 m on.
    """

    q: npt.NDArray[np.float64]
    part: npt.NDArray[np.float64]
    holder: str
    rate: float
    hold: str | None
    handed_over: str | None
    gap_m: float


@dataclass(frozen=True, eq=False)
class Cooperation:
    """What arms that act as one did in many steps: a row for each, with the meaning that `CooperationStep` says.

    Attributes
    ----------
    joints
        The names of the joints, `robot.joint`, in the order of the values.
    q
        `(N, joints)`, rad or m.
    part
        `(N, 4, 4)`, metres.
    holder, hold, handed_over
        A text or `None` per step.
    rate, gap_m
        `(N,)`.
    """

    joints: list[str]
    q: npt.NDArray[np.float64]
    part: npt.NDArray[np.float64]
    holder: list[str]
    rate: npt.NDArray[np.float64]
    hold: list[str | None]
    handed_over: list[str | None]
    gap_m: npt.NDArray[np.float64]

    def _only(self) -> CooperationStep:
        rate, gap_m = float(self.rate[0]), float(self.gap_m[0])
        return CooperationStep(self.q[0], self.part[0], self.holder[0], rate, self.hold[0], self.handed_over[0], gap_m)


@dataclass(frozen=True, eq=False)
class JointMap:
    """Blocked cells of joint space.

    Attributes
    ----------
    robot, joints
        The robot and the joints of the axes.
    centers
        Per axis the joint values of the centres of its cells, rad or m.
    blocked_by
        Number of cells that each object blocks.
    """

    robot: str
    joints: list[str]
    centers: list[npt.NDArray[np.float64]] = field(repr=False)
    blocked_by: dict[str, int]
    _cells: npt.NDArray[np.bool_] = field(repr=False)
    _record: MapRecord | None = field(repr=False)

    @classmethod
    def _of(
        cls,
        robot: str,
        joints: list[str],
        centers: list[npt.NDArray[np.float64]],
        cells: npt.NDArray[np.uint8],
        shape: list[int],
        blocked_by: list[tuple[str, int]],
        record: MapRecord,
    ) -> JointMap:
        blocked = cells.reshape(shape).view(np.bool_)
        blocked.flags.writeable = False
        return cls(robot, joints, centers, dict(blocked_by), blocked, record)

    def __getstate__(self) -> dict[str, Any]:
        """Leave the prepared robot out of copies and pickles."""
        return self.__dict__ | {"_record": None}

    def _prepared(self) -> MapRecord:
        if self._record is None:
            raise ArgumentError("a copied map has cells, but no robot\n  write: the map that `Cell.map` returned")
        return self._record

    def to_numpy(self) -> npt.NDArray[np.bool_]:
        """Return the cells: true if the robot may touch an object there; an axis per joint of `joints`."""
        return self._cells

    def is_blocked(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which states are in blocked cells, or outside of the map; not of a copy.

        Parameters
        ----------
        q
            `(N, axes)`: values of the joints of the map, rad or m.

        Returns
        -------
        ndarray
            `(N,)` bool.
        """
        return self._prepared().are_blocked(q)

    def moved(
        self, objects: Mapping[str, PoseLike] | None = None, *, spheres: npt.NDArray[np.float64] | None = None
    ) -> JointMap:
        """Return the map with objects at other places; only their cells are computed. Not of a copy.

        Parameters
        ----------
        objects
            The pose of each object in the world, by its name; the others stay.
        spheres
            `(K, 4)`: what a sensor sees besides: x, y, z and radius, metres, in the world. They replace earlier ones; without them
            these stay.

        Returns
        -------
        JointMap
        """
        return self._prepared().moved({} if objects is None else objects, spheres)

    @property
    def blocked(self) -> int:
        """Number of blocked cells."""
        return int(self._cells.sum())
