"""Checks recorded motions of robots that act as one continuously, with Pinocchio's kinematics and Coal's distances.

usage: continuous_check.py FOLDER    (as `cargo bench --bench carrying -- MOTIONS ARMS --out FOLDER` writes it)

Between two rows the joints move linearly. A pair of parts is free over a stretch if it is farther apart in its middle than both
can move in half of it; otherwise the stretch is halved. Links of one robot among each other are not checked. A hand may touch the
work-piece while its robot holds it or the recording names it as a visitor.
"""

import json
import sys
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

# A stretch in which the joints move by less is not halved any more: it counts as a contact.
SHORTEST_M = 1e-6


class Arm:
    def __init__(self, urdf, base, tool, joints):
        self.joints, self.dof = joints, 1 + max(joint[1] for joint in joints)
        self.model = pin.buildModelFromUrdf(urdf)
        self.shapes = pin.buildGeomFromUrdf(self.model, urdf, pin.GeometryType.COLLISION, package_dirs=[str(Path(urdf).parent)])
        self.data, self.placed = self.model.createData(), self.shapes.createData()
        self.base = pin.SE3(np.array(base["rotation"]), np.array(base["at"]))
        self.frame = self.model.getFrameId(tool["link"])
        self.hand = coal.Box(*(2.0 * np.array(tool["half_extents"])))
        self.hand_in_link = pin.SE3(np.eye(3), np.array(tool["at"]))
        self.names = [g.name for g in self.shapes.geometryObjects] + ["hand"]
        self.geometry = [g.geometry for g in self.shapes.geometryObjects] + [self.hand]
        for shape in self.geometry:
            shape.computeLocalAABB()

    def configuration(self, values):
        """Pinocchio's configuration: it has coupled joints too, and the cosine and the sine of joints without limits."""
        q = np.empty(self.model.nq)
        for name, index, multiplier, offset in self.joints:
            joint, value = self.model.getJointId(name), multiplier * values[index] + offset
            at = self.model.idx_qs[joint]
            q[at:at + self.model.nqs[joint]] = value if self.model.nqs[joint] == 1 else [np.cos(value), np.sin(value)]
        return q

    def place(self, q):
        pin.forwardKinematics(self.model, self.data, self.configuration(q))
        pin.updateFramePlacements(self.model, self.data)
        pin.updateGeometryPlacements(self.model, self.data, self.shapes, self.placed)
        flange = self.data.oMf[self.frame]
        return [self.base * m for m in self.placed.oMg] + [self.base * flange * self.hand_in_link]


class Cell:
    def __init__(self, setup):
        self.arms = [Arm(arm["urdf"], arm["base"], arm["tool"], arm["joints"]) for arm in setup["arms"]]
        self.bar = coal.Box(*(2.0 * np.array(setup["bar_half_extents"])))
        self.bar.computeLocalAABB()
        self.reach_m = setup["reach_m"]
        parts = [(i, j) for i, arm in enumerate(self.arms) for j in range(len(arm.geometry))]
        self.pairs = [(a, b) for a in parts for b in parts if a[0] < b[0]]
        self.with_bar = parts
        self.request, self.result = coal.DistanceRequest(), coal.DistanceResult()
        self.least_m, self.queries = np.inf, 0

    def distance(self, a, at, b, there):
        apart = np.linalg.norm(at.act(a.aabb_local.center()) - there.act(b.aabb_local.center())) - a.aabb_radius - b.aabb_radius
        if apart > 0.05:
            return apart
        self.result.clear()
        self.queries += 1
        return coal.distance(a, coal.Transform3s(at.rotation, at.translation), b,
                             coal.Transform3s(there.rotation, there.translation), self.request, self.result)

    def nearest(self, row, moved):
        """The least distance less what the pair can move, the distance of that pair, and the pair."""
        placed = [arm.place(q) for arm, q in zip(self.arms, row["q"])]
        holder = row["holder"]
        bar = placed[holder][-1] * row["bar_in_hand"]
        worst = (np.inf, np.inf, None)
        for a, b in self.pairs:
            d = self.distance(self.arms[a[0]].geometry[a[1]], placed[a[0]][a[1]], self.arms[b[0]].geometry[b[1]], placed[b[0]][b[1]])
            self.least_m = min(self.least_m, d)
            worst = min(worst, (d - moved[a[0]] - moved[b[0]], d, (a, b)), key=lambda x: x[0])
        for i, j in self.with_bar:
            is_hand = j == len(self.arms[i].geometry) - 1
            if is_hand and i in (holder, row["visitor"]):
                continue
            d = self.distance(self.arms[i].geometry[j], placed[i][j], self.bar, bar)
            worst = min(worst, (d - moved[holder] - (moved[i] if i != holder else 0.0), d, ((i, j), "bar")), key=lambda x: x[0])
        return worst

    def name(self, part):
        return part if part == "bar" else f"{part[0]}.{self.arms[part[0]].names[part[1]]}"


def check(cell, rows):
    """Contacts over all rows of one motion."""
    found = []
    # Stretches of rows; the ways of the joints along them bound what parts move.
    way = np.cumsum([[0.0] * len(cell.arms)] + [[np.abs(x - y).sum() for x, y in zip(b["q"], a["q"])] for a, b in zip(rows, rows[1:])], axis=0)
    open_ = [(i, min(i + 16, len(rows) - 1), 0.0, 1.0) for i in range(0, len(rows) - 1, 16)]
    while open_:
        first, last, low, high = open_.pop()
        same = all(rows[k]["holder"] == rows[first]["holder"] and rows[k]["visitor"] == rows[first]["visitor"] for k in range(first, last + 1))
        if last - first > 1:
            middle = (first + last) // 2
            if same and cell.nearest(rows[middle], cell.reach_m * np.maximum(way[middle] - way[first], way[last] - way[middle]))[0] > 0.0:
                continue
            open_ += [(first, middle, 0.0, 1.0), (middle, last, 0.0, 1.0)]
            continue
        a, b, share = rows[first], rows[last], 0.5 * (low + high)
        row = dict(a, q=[x + share * (y - x) for x, y in zip(a["q"], b["q"])])
        moved = cell.reach_m * 0.5 * (high - low) * (way[last] - way[first])
        left_m, distance_m, pair = cell.nearest(row, moved)
        if left_m > 0.0:
            continue
        if distance_m <= 0.0 or moved.max() < SHORTEST_M:
            found.append((a["t_s"], [cell.name(part) for part in pair], distance_m))
            continue
        open_ += [(first, last, low, share), (first, last, share, high)]
    return found


def read(file, joints):
    table = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)
    rows = []
    for line in table:
        bar = pin.XYZQUATToSE3(line[3:10])
        ends = 10 + np.cumsum([0] + joints)
        rows.append({"t_s": line[0], "holder": int(line[1]), "visitor": int(line[2]), "bar_in_hand": bar,
                     "q": [line[first:last] for first, last in zip(ends, ends[1:])]})
    return rows


def main():
    folder = Path(sys.argv[1])
    contacts, steps, queries, least_m = 0, 0, 0, np.inf
    for file in sorted(folder.glob("motion_*.csv")):
        cell = Cell(json.loads((folder / file.name.replace("motion_", "cell_")).with_suffix(".json").read_text()))
        rows = read(file, [arm.dof for arm in cell.arms])
        found = check(cell, rows)
        queries, least_m = queries + cell.queries, min(least_m, cell.least_m)
        steps += len(rows)
        contacts += len(found)
        for t_s, pair, distance_m in found[:3]:
            print(f"{file.name}: {t_s:.3f} s: {pair[0]} and {pair[1]}, {distance_m * 1e3:.3f} mm")
    print(f"{steps} rows, {queries} distances, {contacts} contacts; wherever it was looked at, two robots were at least {least_m * 1e3:.2f} mm apart")
    sys.exit(contacts > 0)


main()
