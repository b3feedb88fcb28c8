// The cell at one instant: joint values, poses of links, regions and objects, and the distances between them.
const Cell = (() => {
  const { fromValues, between, multiply, links } = Kinematics;
  const solidOf = (item) => ({ ...item, solid: Distance.solid(item.shape) });
  const volumes = Data.robots.map((robot) => robot.volumes.map(solidOf));
  const targets = [
    ...Data.regions.map((region, index) => ({ kind: 'region', index, name: region.name, color: region.color, solid: Distance.solid(region.shape), measured: region.measured })),
    ...Data.objects.map((object, index) => ({ kind: 'object', index, name: object.name, color: object.color, solid: Distance.solid(object.shape), measured: Data.robots.map((r) => r.measured) })),
  ];

  const isActive = (switches, t) => switches.reduce((on, [at, value]) => (at <= t + 1e-9 ? value : on), false);
  const within = (spans, t) => spans.some(([begin, end]) => t >= begin && t <= end);

  // The frame at or before t, the next one, and how far t is between them, 0 to 1.
  function frameAt(times, t) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t + 1e-6) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, times.length - 1);
    const span = times[next] - times[low];
    return { frame: low, next, part: span > 0 ? Math.min(1, Math.max(0, (t - times[low]) / span)) : 0 };
  }

  const poseAt = (poses, { frame, next, part }) => (poses.length > 7 ? between(poses, 7 * frame, 7 * next, part) : fromValues(poses));

  // Joint values of a recorded robot between two frames.
  function recordedQ(track, dof, { frame, next, part }) {
    return Array.from({ length: dof }, (_, k) => track.q[dof * frame + k] + part * (track.q[dof * next + k] - track.q[dof * frame + k]));
  }

  // The cell of a run at time t; `moved` has joint values that replace the recorded ones.
  function at(runIndex, t, moved) {
    const run = Data.runs[runIndex];
    const frame = frameAt(run.t, t);
    const q = Data.robots.map((robot, i) => (moved && moved[i]) || recordedQ(run.robots[i], robot.sliders.length, frame));
    return {
      run, t, frame, q, moved: Boolean(moved),
      links: Data.robots.map((robot, i) => links(robot, q[i])),
      regions: run.regions.map((region) => ({ pose: poseAt(region.poses, frame), active: isActive(region.active, t) })),
      objects: run.objects.map((object, i) => ({
        pose: object.poses ? poseAt(object.poses, frame) : Data.objects[i].pose,
        held: within(object.held, t),
      })),
    };
  }

  const tcp = (robot, poses) => multiply(poses[robot.flange], robot.tcp);

  // The guarded volume of a robot closest to a region or object: distance (m), part, points; `state` tells why there is none.
  function distance(cell, robot, target) {
    const place = target.kind === 'region' ? cell.regions[target.index] : cell.objects[target.index];
    const counted = target.measured[robot];
    if (!counted.length) return { state: 'none' };
    if (!target.solid) return { state: 'not measured: too many triangles' };
    if (place.held) return { state: 'held by a robot' };
    let best = null;
    for (const index of counted) {
      const volume = volumes[robot][index];
      if (!volume.solid) continue;
      const pose = multiply(cell.links[robot][volume.link], volume.pose);
      const found = Distance.between(volume.solid, pose, target.solid, place.pose, best ? best.distance : Infinity);
      if (found && (!best || found.distance < best.distance)) best = { ...found, part: volume.name };
      if (best && best.distance === 0) break;
    }
    return best ? { ...best, state: target.kind === 'region' && !place.active ? 'off' : '' } : { state: 'none' };
  }

  // A pair of a robot and a region or object with its distance.
  const pair = (cell, robot, target) => ({ robot, target, ...distance(cell, robot, target) });

  // All pairs that concern each other.
  function pairs(cell) {
    return Data.robots.flatMap((_, robot) => targets.map((target) => pair(cell, robot, target)).filter((d) => d.state !== 'none'));
  }

  return { targets, at, tcp, pair, pairs };
})();
