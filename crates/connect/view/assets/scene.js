// The 3-D scene and its camera.
const Scene = (() => {
  // Robots at their start with the reach of their wrists, objects, regions with their warning zones.
  function corners(boxCorners) {
    const points = [];
    const add = (mesh, pose) => points.push(...boxCorners(Data.meshes[mesh], pose));
    for (const robot of Data.robots) {
      const poses = Kinematics.links(robot, robot.start);
      robot.solids.forEach((solid) => add(solid.mesh, Kinematics.multiply(poses[solid.link], solid.pose)));
    }
    Data.objects.forEach((object) => add(object.mesh, object.pose));
    Data.regions.forEach((region) => add(region.shell ?? region.solid, region.pose));
    return points;
  }
  const stage = createStage(corners, Instant.lineCount);
  const stateNames = { off: 'off', inside: 'inside', warned: 'warning', closed: 'closed', active: '' };
  let showsLines = true, last = null;

  function show(instant) {
    last = instant;
    stage.show({
      robots: instant.robots, objects: instant.objects,
      regions: instant.regions.map((r) => ({ ...r, inside: r.inside.length > 0, warned: r.warned.length > 0, state: stateNames[r.state] })),
      lines: showsLines ? instant.lines : instant.lines.map(() => null),
    });
  }

  // Towards the point about which the camera turns, or away from it.
  function zoom(factor) {
    if (!stage.works) return;
    const { camera, controls } = stage;
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    stage.request();
  }

  // Pixels of a point of the world in the canvas; null behind the camera.
  function pixels(point) {
    const p = point.clone().project(stage.camera), { width, height } = stage.canvas.getBoundingClientRect();
    return p.z > 1 ? null : [((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height];
  }

  // The ray from the eye through a place of the canvas.
  function ray(x, y) {
    const { camera, canvas } = stage, { width, height } = canvas.getBoundingClientRect();
    const through = new THREE.Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(camera);
    return { origin: camera.position.clone(), along: through.sub(camera.position).normalize() };
  }

  const views = { 'look-top': [0, 0.001, -1], 'look-front': [0, 1, -0.05], 'look-side': [-1, 0, -0.05] };
  for (const [id, along] of Object.entries(views)) byId(id).addEventListener('click', () => stage.look(along));
  byId('fit').addEventListener('click', stage.fit);
  byId('closer').addEventListener('click', () => zoom(0.8));
  byId('farther').addEventListener('click', () => zoom(1.25));
  byId('show-lines').addEventListener('change', ({ target }) => { showsLines = target.checked; if (last) show(last); });

  return { stage, show, pixels, ray };
})();
