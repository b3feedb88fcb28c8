// The 3-D scene of a run: the cell at an instant, with the paths of the tool centre points.
const Stage = (() => {
  // Corners of the boxes of everything: robots along the runs, objects, regions with their warning zones.
  function corners(boxCorners) {
    const points = [];
    const add = (mesh, p) => points.push(...boxCorners(mesh, p));
    Data.runs.forEach((run, r) => {
      if (!run.t.length) return;
      for (let n = 0; n <= 24; n++) {
        const cell = Cell.at(r, (run.t[run.t.length - 1] * n) / 24);
        Data.robots.forEach((robot, i) => robot.solids.forEach((s) => add(Data.meshes[s.mesh], Kinematics.multiply(cell.links[i][s.link], s.pose))));
        if (n % 6 === 0) Data.objects.forEach((object, i) => add(Data.meshes[object.mesh], cell.objects[i].pose));
        if (n % 6 === 0) Perceived.known(run, cell.t).forEach((o) => o.outline.forEach(([x, y]) => points.push(new THREE.Vector3(x, y, o.bottom + o.height))));
        if (n % 6 === 0) Data.regions.forEach((region, i) => add(Data.meshes[region.shell ?? region.solid], cell.regions[i].pose));
      }
    });
    return points;
  }
  const stage = createStage(corners, Data.robots.length);

  // Paths of the tool centre points, coloured by the override: red at 0, yellow at 0.5, green at 1.
  const paths = !stage.works ? [] : Data.runs.map((run) => {
    const group = new THREE.Group();
    run.robots.forEach((track, i) => {
      const robot = Data.robots[i], dof = robot ? robot.sliders.length : 0;
      if (!robot) return;
      const points = new Float32Array(3 * run.t.length), colors = new Float32Array(3 * run.t.length);
      for (let frame = 0; frame < run.t.length; frame++) {
        const q = track.q.subarray(dof * frame, dof * frame + dof);
        points.set(Cell.tcp(track, Kinematics.links(robot, q), run.t[frame]).slice(9), 3 * frame);
        stage.overrideColor(track.override[frame]).toArray(colors, 3 * frame);
      }
      const line = new THREE.BufferGeometry();
      line.setAttribute('position', new THREE.BufferAttribute(points, 3));
      line.setAttribute('color', new THREE.BufferAttribute(colors, 3));
      group.add(new THREE.Line(line, new THREE.LineBasicMaterial({ vertexColors: true })));
    });
    stage.add(group);
    return group;
  });

  const perceived = stage.works ? Perceived.layer() : null;
  if (perceived) stage.add(perceived.group);

  // Shows a cell; per robot a line to show, or null.
  function show(runIndex, cell, pairs) {
    const { t, run } = cell;
    const during = (spans) => !cell.moved && spans.some(([, begin, end]) => t >= begin && t <= end);
    const region = ({ pose, active }, i) => {
      const inside = during(run.regions[i].inside), warned = during(run.regions[i].warning);
      return { pose, active, inside, warned, state: !active ? 'off' : inside ? 'inside' : warned ? 'warning' : '' };
    };
    const line = (pair) => pair && { ...pair, text: `${pair.part} – ${pair.target.name} ${millimetres(pair.distance)}` };
    paths.forEach((path, i) => { path.visible = i === runIndex; });
    if (perceived) perceived.show(run, t);
    stage.show({
      robots: cell.links.map((links, i) => ({
        links, absent: cell.absent[i], tcp: Cell.tcp(run.robots[i], links, t).slice(9),
        level: cell.moved ? 1 : run.robots[i].override[cell.frame.frame],
      })),
      objects: cell.objects, regions: cell.regions.map(region), lines: pairs.map(line),
      shields: Data.shields.map((shield, i) => run.shields[i].findLast(([since]) => since <= t)?.[1] ?? shield.active),
    });
  }

  return { show, fit: stage.fit, perceived: () => (perceived ? perceived.drawn() : []) };
})();
