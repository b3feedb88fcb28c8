"""Poses, velocities and accelerations of all links by Pinocchio, for tests/pinocchio.rs.

usage: pin_reference.py < robots

Of each robot standard input has a line with the file, the names of the independent joints, the names of the links and the
number of states, between tabulators; names between commas. A line for each state follows: q, then qd, then qdd of the
joints. For each state and each link one line is printed: the 3x4 pose by rows, then linear and angular velocity, then
linear and angular acceleration of the link frame's origin, all in the root link's frame.

The URDF is read by Pinocchio's own reader. Mimic joints are free there; their values are set here from the file.
"""

import sys
import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin


def build(path):
    model = pin.buildModelFromUrdf(path)
    joints = ET.parse(path).getroot().findall("joint")
    return model, {j.get("name"): j.find("mimic") for j in joints if j.find("mimic") is not None}


def joint_values(name, mimics, free):
    """(q, qd, qdd) of a joint, mimics followed to the end."""
    if name in free:
        return np.array(free[name])
    mimic = mimics[name]
    factor, offset = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
    return factor * joint_values(mimic.get("joint"), mimics, free) + np.array([offset, 0.0, 0.0])


def print_states(path, names, links, lines):
    model, mimics = build(path)
    data = model.createData()
    frames = [model.getFrameId(link, pin.FrameType.BODY) for link in links]
    assert all(frame < model.nframes for frame in frames), f"{path}: a link that Pinocchio does not know"
    around_link = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    for line in lines:
        values = np.array([float(word) for word in line.split()]).reshape(3, -1)
        free = {name: values[:, i] for i, name in enumerate(names)}
        q, qd, qdd = np.zeros(model.nq), np.zeros(model.nv), np.zeros(model.nv)
        for i in range(1, model.njoints):
            joint = model.joints[i]
            value, qd[joint.idx_v], qdd[joint.idx_v] = joint_values(model.names[i], mimics, free)
            # Continuous joints are a point on the unit circle.
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.forwardKinematics(model, data, q, qd, qdd)
        pin.updateFramePlacements(model, data)
        for frame in frames:
            pose = data.oMf[frame].homogeneous[:3].ravel()
            v = pin.getFrameVelocity(model, data, frame, around_link)
            a = pin.getFrameClassicalAcceleration(model, data, frame, around_link)
            row = np.concatenate([pose, v.linear, v.angular, a.linear, a.angular])
            print(" ".join(repr(float(x)) for x in row))


def main():
    for header in sys.stdin:
        path, names, links, states = header.rstrip("\n").split("\t")
        print_states(path, names.split(","), links.split(","), [next(sys.stdin) for _ in range(int(states))])
        # The other side waits for the answer before it sends the next robot.
        sys.stdout.flush()


main()
