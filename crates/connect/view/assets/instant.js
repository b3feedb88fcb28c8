// What a frame says about the cell: poses of links, regions and objects, and the lines to draw.
const Instant = (() => {
  const { fromValues, links, multiply } = Kinematics;
  for (const region of Data.regions) region.pose = fromValues(region.pose);
  for (const robot of Data.robots) robot.tcp.pose = fromValues(robot.tcp.pose);
  const atStart = Data.robots.map((robot) => links(robot, robot.start));
  const placed = ({ position_m: p, quaternion_xyzw: q }) => fromValues([...q, ...p]);

  // A region over all robots that it applies to: switched off, entered, in its warning zone, closed to somebody, or free.
  function region(frame, { name, kind, pose, life }) {
    const of = frame.robots.flatMap((robot) => robot.regions.filter((r) => r.name === name).map((r) => ({ robot: robot.robot, ...r })));
    const where = (key) => of.filter((r) => r[key]).map((r) => r.robot);
    const [inside, warned, closedTo] = [where('inside'), where('warned'), where('closed')];
    const active = of.length ? of.some((r) => r.active) : life === 'permanent';
    const slot = frame.slots.find((s) => s.regions.includes(name));
    const isTaken = kind === 'exchange' && closedTo.length > 0;
    const state = !active ? 'off' : inside.length ? 'inside' : warned.length ? 'warned' : isTaken ? 'closed' : 'active';
    return {
      name, kind, state, active, inside, warned, closed_to: closedTo, holder: slot ? slot.holder : null, queue: slot ? slot.queue : [],
      pose: of.length ? placed(of[0].pose) : pose,
    };
  }

  // The region to which a line of the robot leads: the one that limits it, else the nearest one that is on and near.
  function regionLine(robot, regions) {
    const isOn = (d) => regions.find((r) => r.name === d.region)?.active;
    const governing = robot.distances.find((d) => d.region === robot.region);
    const near = robot.distances.filter(isOn).filter((d) => d.distance_m < 0.5);
    const nearest = near.reduce((best, d) => (!best || d.distance_m < best.distance_m ? d : best), null);
    const d = governing || nearest;
    return d && { onA: d.points_m[0], onB: d.points_m[1], text: `${robot.robot}: ${d.part} – ${d.region} ${Units.toRegion(d.distance_m)}` };
  }

  const pairLine = (pair) => pair && { onA: pair.points_m[0], onB: pair.points_m[1], text: `${pair.a} – ${pair.b} ${Units.millimetres(pair.distance_m)}` };
  // The same pair may be nearest to two robots.
  const samePair = (x, y) => x && y && ((x.a === y.a && x.b === y.b) || (x.a === y.b && x.b === y.a));

  // Everything of a frame that is drawn and listed.
  function of(frame) {
    const robots = frame.robots.map((robot, i) => {
      const isKnown = robot.q.length === Data.robots[i].sliders.length && robot.q.length > 0;
      const poses = isKnown ? links(Data.robots[i], robot.q) : atStart[i];
      const tcp = multiply(poses[Data.robots[i].tcp.link], Data.robots[i].tcp.pose);
      return { isKnown, links: poses, absent: Data.robots[i].absent, tcp: tcp.slice(9), level: isKnown ? robot.override : 0 };
    });
    const regions = Data.regions.map((r) => region(frame, r));
    // Regions that the running cell has and its file has not: listed, but their shape is unknown here.
    const names = new Set(frame.robots.flatMap((robot) => robot.regions.map((r) => r.name)));
    Data.regions.forEach((r) => names.delete(r.name));
    const added = [...names].map((name) => region(frame, { name, kind: 'added', pose: [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], life: 'temporary' }));
    const objects = Data.objects.map((object) => {
      const moved = frame.objects.find((o) => o.name === object.name);
      return { name: object.name, pose: moved ? placed(moved.pose) : object.pose };
    });
    const pairs = frame.robots.map((robot, i) => (frame.robots.slice(0, i).some((other) => samePair(other.nearest, robot.nearest)) ? null : robot.nearest));
    const lines = frame.robots.flatMap((robot, i) => [pairLine(pairs[i]), regionLine(robot, regions)]);
    return { frame, robots, regions, added, objects, lines };
  }

  return { of, lineCount: 2 * Data.robots.length };
})();
