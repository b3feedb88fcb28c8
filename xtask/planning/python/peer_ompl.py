"""OMPL's RRT-Connect, true meshes and true cylinders: Pinocchio and Coal say what is free, at 32 states per radian."""

import numpy as np
from ompl import base, geometric, util

import attempts
import job
from solids import Cell, Robot

RESOLUTION = 1.0 / 32.0
SECONDS = 10.0


def space_of(robot, joints):
    space, bounds = base.RealVectorStateSpace(len(joints)), base.RealVectorBounds(len(joints))
    for k, name in enumerate(joints):
        at = robot.index[name]
        bounds.setLow(k, float(robot.model.lowerPositionLimit[at]))
        bounds.setHigh(k, float(robot.model.upperPositionLimit[at]))
    space.setBounds(bounds)
    return space


def states(path, count):
    return [[state[k] for k in range(count)] for state in path.getStates()]


def attempt(robot, problem, seed):
    joints, cell = problem.joints(), Cell(robot, problem.solids, problem.allowed)
    still = robot.values(problem.start)
    at = [robot.index[name] for name in joints]

    def free(state):
        q = still.copy()
        q[at] = [state[k] for k in range(len(joints))]
        return cell.collides(q) is None

    start, goal = problem.arm(problem.start), problem.arm(problem.goal)
    record = attempts.unsolved(problem, seed, free(start) and free(goal))
    if not record["valid"]:
        return record
    space = space_of(robot, joints)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(free)
    information = setup.getSpaceInformation()
    information.setStateValidityCheckingResolution(RESOLUTION / space.getMaximumExtent())
    ends = [space.allocState(), space.allocState()]
    for state, q in zip(ends, (start, goal)):
        for k, x in enumerate(q):
            state[k] = float(x)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(information))
    setup.solve(SECONDS)
    if not setup.haveExactSolutionPath():
        return record
    raw = states(setup.getSolutionPath(), len(joints))
    planning = setup.getLastPlanComputationTime()
    setup.simplifySolution()
    path = states(setup.getSolutionPath(), len(joints))
    return record | {
        "solved": True,
        "planning_us": planning * 1e6,
        "simplify_us": setup.getLastSimplificationTime() * 1e6,
        "cost_raw": attempts.length(raw),
        "cost": attempts.length(path),
        "path": path,
    }


def main():
    task = job.read()
    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(task.seed + 1)
    robot = Robot(task.urdf, task.srdf)
    attempts.write(task.out, [attempt(robot, problem, task.seed) for problem in task.problems])


if __name__ == "__main__":
    main()
