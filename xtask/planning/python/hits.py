"""Whether a path hits the true meshes and primitives at one of 10,000 points.

Every point counts, but not every point is asked for: where the distance at one is d, those that follow are free as long
as no point of the robot can have moved by d.
"""

import numpy as np

from solids import Cell

POINTS = 10_000
# Distances above this are not measured to the end.
ENOUGH = 0.015


class PathCheck:
    def __init__(self, robot, problem):
        self.robot, self.reach = robot, robot.reach()
        self.cell = Cell(robot, problem.solids, problem.allowed)
        self.problem = problem

    def rows(self, names, states):
        """Pinocchio's configurations; joints that the path lacks (the fingers) stay as in the problem's start."""
        return np.array([self.robot.values(self.problem.start, dict(zip(names, state))) for state in states])

    def end_hits(self):
        """The first pair that touches at the start or the goal."""
        start = self.robot.values(self.problem.start)
        goal = self.robot.values(self.problem.start, self.problem.goal)
        return self.cell.collides(start) or self.cell.collides(goal)

    def hit(self, names, states):
        """Where along the path (0 to 1) and with which pair it first touches; None where it is free."""
        points = spread(self.rows(names, states), POINTS)
        moved = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points, axis=0)) @ self.reach)])
        i = 0
        while i < len(points):
            clearance = self.cell.clearance(points[i], ENOUGH)
            if clearance <= 0.0:
                # The distance of meshes that touch is 0 up to rounding: the collision query has the say.
                pair = self.cell.collides(points[i])
                if pair:
                    return i / (len(points) - 1), pair
            # The last term is above what Coal leaves undecided.
            i = max(i + 1, int(np.searchsorted(moved, moved[i] + clearance - 1e-5)))
        return None


def spread(states, count):
    """`count` points along the polyline, evenly by joint length, both ends among them."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(states, axis=0), axis=1))])
    at = np.linspace(0.0, lengths[-1], count)
    return np.stack([np.interp(at, lengths, column) for column in states.T], axis=1)
