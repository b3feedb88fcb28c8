"""Distances of pairs of convex shapes by Coal: a pair per line on the standard input, a number per line on the output.

A shape is its kind and its sizes in metres, then twelve numbers: the rows of its rotation, each followed by the coordinate of
its origin. A tab separates the two shapes.
"""

import sys

import coal
import numpy as np

MAKERS = {
    "sphere": lambda size: coal.Sphere(size[0]),
    "capsule": lambda size: coal.Capsule(size[1], 2.0 * size[0]),
    "cylinder": lambda size: coal.Cylinder(size[1], 2.0 * size[0]),
    "box": lambda size: coal.Box(2.0 * np.array(size)),
}


def hull(corners):
    points = coal.StdVec_Vec3s()
    points.extend(list(np.array(corners).reshape(-1, 3)))
    return coal.Convex.convexHull(points, False, "Qt")


def placed(words):
    kind, numbers = words[0], [float(word) for word in words[1:]]
    size, pose = numbers[:-12], np.array(numbers[-12:]).reshape(3, 4)
    shape = hull(size) if kind == "hull" else MAKERS[kind](size)
    return shape, coal.Transform3s(pose[:, :3], pose[:, 3])


def main():
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    # Far below the tolerance of the test.
    request.gjk_tolerance = 1e-10
    request.gjk_max_iterations = 1000
    for line in sys.stdin:
        (a, at), (b, there) = (placed(shape.split()) for shape in line.split("\t"))
        result.clear()
        print(coal.distance(a, at, b, there, request, result))


main()
