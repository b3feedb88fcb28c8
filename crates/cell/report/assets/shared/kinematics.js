// Poses and forward kinematics, in metres, radians and f64. A pose is an array of 12: the rows of its rotation, then the
// translation.
const Kinematics = (() => {
  // From a quaternion x y z w and a translation, at an offset of an array.
  function fromValues(v, at = 0) {
    const n = Math.hypot(v[at], v[at + 1], v[at + 2], v[at + 3]) || 1;
    const [x, y, z, w] = [v[at] / n, v[at + 1] / n, v[at + 2] / n, v[at + 3] / n];
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
      v[at + 4], v[at + 5], v[at + 6],
    ];
  }

  // Between two poses of an array: straight, and by the shortest rotation.
  function between(v, from, to, part) {
    const sign = v[from] * v[to] + v[from + 1] * v[to + 1] + v[from + 2] * v[to + 2] + v[from + 3] * v[to + 3] < 0 ? -1 : 1;
    const mixed = new Array(7);
    for (let k = 0; k < 7; k++) mixed[k] = v[from + k] + part * ((k < 4 ? sign : 1) * v[to + k] - v[from + k]);
    return fromValues(mixed);
  }

  function multiply(a, b) {
    const out = new Array(12);
    for (let r = 0; r < 3; r++) {
      const [x, y, z] = [a[3 * r], a[3 * r + 1], a[3 * r + 2]];
      for (let c = 0; c < 3; c++) out[3 * r + c] = x * b[c] + y * b[3 + c] + z * b[6 + c];
      out[9 + r] = x * b[9] + y * b[10] + z * b[11] + a[9 + r];
    }
    return out;
  }

  // The pose of a in the frame of b.
  function relative(b, a) {
    const inverse = [b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], b[8], 0, 0, 0];
    for (let r = 0; r < 3; r++) inverse[9 + r] = -(inverse[3 * r] * b[9] + inverse[3 * r + 1] * b[10] + inverse[3 * r + 2] * b[11]);
    return multiply(inverse, a);
  }

  const apply = (p, [x, y, z]) => [
    p[0] * x + p[1] * y + p[2] * z + p[9],
    p[3] * x + p[4] * y + p[5] * z + p[10],
    p[6] * x + p[7] * y + p[8] * z + p[11],
  ];

  // Rotation about a unit axis, or translation along it.
  function motion(joint, value) {
    const [x, y, z] = joint.axis;
    if (joint.slides) return [1, 0, 0, 0, 1, 0, 0, 0, 1, x * value, y * value, z * value];
    const c = Math.cos(value), s = Math.sin(value), k = 1 - c;
    return [
      c + x * x * k, x * y * k - z * s, x * z * k + y * s,
      y * x * k + z * s, c + y * y * k, y * z * k - x * s,
      z * x * k - y * s, z * y * k + x * s, c + z * z * k,
      0, 0, 0,
    ];
  }

  for (const robot of Data.robots) {
    robot.base = fromValues(robot.base);
    for (const joint of robot.joints) joint.origin = fromValues(joint.origin);
    for (const part of [...robot.solids, ...robot.volumes, ...robot.gripped.map((g) => g.volume)]) part.pose = fromValues(part.pose);
  }
  for (const thing of [...Data.objects, ...Data.shields, ...Data.grids]) thing.pose = fromValues(thing.pose);

  // The pose of every link in the world; q has one value per slider.
  function links(robot, q) {
    const poses = new Array(robot.links).fill(robot.base);
    for (const joint of robot.joints) {
      let pose = multiply(poses[joint.parent], joint.origin);
      if (joint.index !== null) pose = multiply(pose, motion(joint, joint.factor * q[joint.index] + joint.offset));
      poses[joint.child] = pose;
    }
    return poses;
  }

  return { fromValues, between, multiply, relative, apply, links };
})();
