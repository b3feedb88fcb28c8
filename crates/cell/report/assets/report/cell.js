// The cell at one instant: joint values, poses of links, regions and objects, and the distances between them.
const Cell = (() => {
  const { fromValues, between, multiply, relative, links } = Kinematics;
  const solidOf = (item) => ({ ...item, solid: Distance.solid(item.shape) });
  const volumes = Data.robots.map((robot) => robot.volumes.map(solidOf));
  const gripped = Data.robots.map((robot) => robot.gripped.map(({ object, volume }) => ({ object, ...solidOf(volume) })));
  const targets = [
    ...Data.regions.map((region, index) => ({ kind: 'region', index, name: region.name, color: region.color, solid: Distance.solid(region.shape), measured: region.measured, guardsLoad: region.guards_load })),
    ...Data.objects.map((object, index) => ({ kind: 'object', index, name: object.name, color: object.color, solid: Distance.solid(object.shape), measured: Data.robots.map((r) => r.measured) })),
  ];

  // The value of the last of some changes [time, ...value].
  const lastOf = (changes, t) => changes.reduce((now, change) => (change[0] <= t + 1e-6 ? change : now), null);
  const isActive = (switches, t) => switches.reduce((on, [at, value]) => (at <= t + 1e-9 ? value : on), false);

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
    const recorded = Data.robots.map((robot, i) => recordedQ(run.robots[i], robot.sliders.length, frame));
    const q = recorded.map((values, i) => (moved && moved[i]) || values);
    const poses = Data.robots.map((robot, i) => links(robot, q[i]));
    const objects = run.objects.map((object, i) => {
      const pose = object.poses ? poseAt(object.poses, frame) : Data.objects[i].pose;
      const span = object.held.find(([, begin, end]) => t >= begin && t <= end);
      if (!span) return { pose, holder: null };
      const holder = span[0], link = lastOf(run.robots[holder].tcps, t)[1];
      if (!moved || !moved[holder]) return { pose, holder, link };
      // Where joints are moved, what is held moves along.
      const inLink = relative(links(Data.robots[holder], recorded[holder])[link], pose);
      return { pose: multiply(poses[holder][link], inLink), holder, link };
    });
    return {
      run, t, frame, q, moved: Boolean(moved), links: poses, objects,
      absent: run.robots.map((track) => (lastOf(track.absent, t) || [0, []])[1]),
      regions: run.regions.map((region) => ({ pose: poseAt(region.poses, frame), active: isActive(region.active, t) })),
    };
  }

  // The pose of the tool centre point that is active at time t.
  function tcp(track, poses, t) {
    const [, link, pose] = lastOf(track.tcps, t);
    return multiply(poses[link], fromValues(pose));
  }

  // The volumes of a robot that count for a region or object, with their poses: its own, and those of what it holds.
  function countedVolumes(cell, robot, target) {
    const own = target.measured[robot].map((index) => volumes[robot][index])
      .filter((volume) => !volume.exchanged || !cell.absent[robot].includes(volume.link))
      .map((volume) => ({ ...volume, at: multiply(cell.links[robot][volume.link], volume.pose) }));
    const countsLoad = target.kind === 'object' || target.guardsLoad;
    const held = gripped[robot].filter(({ object, link }) => {
      const place = cell.objects[object];
      return countsLoad && own.length && place.holder === robot && place.link === link;
    });
    return own.concat(held.map((volume) => ({ ...volume, at: multiply(cell.objects[volume.object].pose, volume.pose) })));
  }

  // The guarded volume of a robot closest to a region or object: distance (m), part, points; `state` tells why there is none.
  function distance(cell, robot, target) {
    const place = target.kind === 'region' ? cell.regions[target.index] : cell.objects[target.index];
    const counted = countedVolumes(cell, robot, target);
    if (!counted.length) return { state: 'none' };
    if (!target.solid) return { state: 'not measured: too many triangles' };
    if (target.kind === 'object' && place.holder !== null) return { state: 'held by a robot' };
    let best = null;
    for (const volume of counted) {
      if (!volume.solid) continue;
      const found = Distance.between(volume.solid, volume.at, target.solid, place.pose, best ? best.distance : Infinity);
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
