"""Collision awareness for industrial robot cells.

>>> import numpy as np, elbowroom as er
>>> robot = er.Robot.load("arm.urdf")                      # doctest: +SKIP
>>> er.Checker(robot).distance(np.zeros((1, robot.dof)))   # doctest: +SKIP

Joint values are `(N, dof)` arrays of float64, radians for joints that turn and metres for joints that slide; a row is a
state. Lengths are metres, times seconds. For a cell the robots stand side by side in the order of the file.
"""

from elbowroom._elbowroom import (
    Cell,
    Checker,
    GuidedArm,
    Monitor,
    Planner,
    ReachQuery,
    Robot,
    Rules,
    VirtualRobot,
    __version__,
)
from elbowroom.errors import ArgumentError, ArrayError, Error, FileError
from elbowroom.pages import save, show
from elbowroom.results import (
    Cooperation,
    CooperationStep,
    Edges,
    Guidance,
    GuidedStep,
    JointMap,
    Mesh,
    Overrides,
    Path,
    Reach,
    Run,
    Tick,
    Trace,
    Witness,
)
from elbowroom.scene import Scene
from elbowroom.trajectory import Trajectory

__all__ = [
    "ArgumentError",
    "ArrayError",
    "Cell",
    "Checker",
    "Cooperation",
    "CooperationStep",
    "Edges",
    "Error",
    "FileError",
    "Guidance",
    "GuidedArm",
    "GuidedStep",
    "JointMap",
    "Mesh",
    "Monitor",
    "Overrides",
    "Path",
    "Planner",
    "Reach",
    "ReachQuery",
    "Robot",
    "Rules",
    "Run",
    "Scene",
    "Tick",
    "Trace",
    "Trajectory",
    "VirtualRobot",
    "Witness",
    "__version__",
    "save",
    "show",
]
