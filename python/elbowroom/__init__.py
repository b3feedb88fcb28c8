"""Collision awareness for industrial robot cells.

>>> import numpy as np, elbowroom as er
>>> robot = er.Robot.load("arm.urdf")                      # doctest: +SKIP
>>> er.Checker(robot).distance(np.zeros((1, robot.dof)))   # doctest: +SKIP

Joint values are `(N, dof)` arrays of float64, radians for joints that turn and metres for joints that slide; a row is a
state. Lengths are metres, times seconds. For a cell the robots stand side by side in the order of the file.
"""

from elbowroom._elbowroom import Cell, Checker, GuidedArm, Monitor, Planner, ReachQuery, Robot, __version__
from elbowroom.errors import ArgumentError, ArrayError, Error, FileError
from elbowroom.pages import save, show
from elbowroom.results import Edges, Guidance, GuidedStep, JointMap, Overrides, Path, Reach, Run, Tick, Trace, Witness
from elbowroom.scene import Scene

__all__ = [
    "ArgumentError",
    "ArrayError",
    "Cell",
    "Checker",
    "Edges",
    "Error",
    "FileError",
    "Guidance",
    "GuidedArm",
    "GuidedStep",
    "JointMap",
    "Monitor",
    "Overrides",
    "Path",
    "Planner",
    "Reach",
    "ReachQuery",
    "Robot",
    "Run",
    "Scene",
    "Tick",
    "Trace",
    "Witness",
    "__version__",
    "save",
    "show",
]
