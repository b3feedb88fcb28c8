// Handles at the tool centre points: the ball is dragged in the plane of the screen, an arrow along its axis of the world.
const Drag = (() => {
  const { stage, pixels, ray } = Scene;
  if (!Jog.isOn || !stage.works) return { handles: () => [], enable: () => {} };
  const { camera, canvas } = stage, box = canvas.parentElement;
  const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]], COLORS = ['#d8402f', '#2f9e44', '#2b6fd6'];
  const LENGTH = 0.09, REACH_PX = 13; // length as a share of the distance of the camera
  const vector = (v) => new THREE.Vector3(...v);

  const groups = Data.robots.map(() => {
    const group = new THREE.Group();
    AXES.forEach((axis, k) => {
      const arrow = new THREE.ArrowHelper(vector(axis), vector([0, 0, 0]), 1, COLORS[k], 0.28, 0.16);
      for (const part of [arrow.line, arrow.cone]) { part.material.depthTest = false; part.renderOrder = 8; }
      group.add(arrow);
    });
    const ball = new THREE.Mesh(new THREE.SphereGeometry(0.1, 16, 12), new THREE.MeshBasicMaterial({ color: '#e8a800', depthTest: false }));
    ball.renderOrder = 9;
    group.add(ball);
    group.visible = false;
    stage.add(group);
    return group;
  });

  function place(instant) {
    groups.forEach((group, i) => {
      group.visible = isEnabled && instant.robots[i].isKnown;
      group.position.set(...instant.robots[i].tcp);
    });
  }
  stage.onRender(() => groups.forEach((group) => group.scale.setScalar(LENGTH * camera.position.distanceTo(group.position))));

  const tip = (group, axis) => group.position.clone().addScaledVector(vector(AXES[axis]), group.scale.x);

  // The handle at a place of the canvas: a robot, and an axis or null for the ball.
  function hit(x, y) {
    let best = null;
    const offer = (distance, robot, axis) => { if (distance < REACH_PX && (!best || distance < best.distance)) best = { distance, robot, axis }; };
    groups.forEach((group, robot) => {
      const from = group.visible && pixels(group.position);
      if (!from) return;
      offer(Math.hypot(x - from[0], y - from[1]) - 4, robot, null);
      AXES.forEach((_, axis) => {
        const to = pixels(tip(group, axis));
        if (!to) return;
        const [dx, dy] = [to[0] - from[0], to[1] - from[1]], square = dx * dx + dy * dy;
        // An axis that points at the viewer has no length on the screen.
        if (square < 100) return;
        const along = Math.min(1, Math.max(0.25, ((x - from[0]) * dx + (y - from[1]) * dy) / square));
        offer(Math.hypot(x - from[0] - along * dx, y - from[1] - along * dy), robot, axis);
      });
    });
    return best;
  }

  // The point of the plane of the screen through `at`, or of the axis through it, that is under the pointer.
  function under(at, axis, x, y) {
    const { origin, along } = ray(x, y), between = at.clone().sub(origin);
    if (axis === null) {
      const normal = camera.getWorldDirection(new THREE.Vector3());
      return origin.addScaledVector(along, between.dot(normal) / along.dot(normal));
    }
    const direction = vector(AXES[axis]), cosine = direction.dot(along), sine = 1 - cosine * cosine;
    if (sine < 1e-4) return at.clone();
    return at.clone().addScaledVector(direction, (cosine * between.dot(along) - between.dot(direction)) / sine);
  }

  let held = null, isEnabled = true;
  // While points are drawn, handles are neither shown nor moved.
  function enable(on) {
    isEnabled = on;
    groups.forEach((group) => { group.visible = on; });
    stage.request();
  }
  const place_ = ({ clientX, clientY }) => { const { left, top } = canvas.getBoundingClientRect(); return [clientX - left, clientY - top]; };
  // Before the camera's controls, which listen at the canvas.
  box.addEventListener('pointerdown', (event) => {
    const [x, y] = place_(event), found = isEnabled && event.button === 0 && hit(x, y), tcp = found && Jog.tcp(found.robot);
    if (!tcp) return;
    event.stopPropagation();
    event.preventDefault();
    canvas.focus();
    box.setPointerCapture(event.pointerId);
    const start = vector(tcp.position_m);
    held = { ...found, start, from: under(start, found.axis, x, y), rotation: tcp.quaternion_xyzw };
  }, { capture: true });
  box.addEventListener('pointermove', (event) => {
    const [x, y] = place_(event);
    if (!held) { box.classList.toggle('grab', isEnabled && Boolean(hit(x, y))); return; }
    event.stopPropagation();
    const to = held.start.clone().add(under(held.start, held.axis, x, y)).sub(held.from);
    Jog.moveTcp(held.robot, [to.x, to.y, to.z], held.rotation);
  }, { capture: true });
  const drop = (event) => { if (held) { held = null; event.stopPropagation(); } };
  box.addEventListener('pointerup', drop, { capture: true });
  box.addEventListener('pointercancel', drop, { capture: true });

  // Where the handles are in the canvas, for tests.
  const handles = () => groups.map((group) => ({ ball: pixels(group.position), tips: AXES.map((_, axis) => pixels(tip(group, axis))) }));
  return { place, handles, enable };
})();
