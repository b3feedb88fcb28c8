// Obstacles that sensors see, as translucent prisms: what the robots knew at an instant, not where the obstacles were.
const Perceived = (() => {
  const COLORS = ['#00838f', '#ad6c00', '#5d6d1e'];

  // What every sensor of a run knew at time t: its last record that was usable by then.
  function known(run, t) {
    return run.sensors.flatMap((sensor, index) => {
      const record = sensor.records.reduce((last, one) => (one.t <= t + 1e-9 ? one : last), null);
      return record ? record.obstacles.map((o) => ({ ...o, sensor: index, name: `${sensor.name}#${o.id}` })) : [];
    });
  }

  // The side and top faces of an upright prism, counter-clockwise from outside.
  function geometry({ outline, bottom, height }) {
    const n = outline.length, points = new Float32Array(6 * n), faces = [];
    outline.forEach(([x, y], k) => {
      points.set([x, y, bottom], 3 * k);
      points.set([x, y, bottom + height], 3 * (n + k));
      const next = (k + 1) % n;
      faces.push(k, next, n + next, k, n + next, n + k);
      if (k > 1) faces.push(n, n + k - 1, n + k, 0, k, k - 1);
    });
    const prism = new THREE.BufferGeometry();
    prism.setAttribute('position', new THREE.BufferAttribute(points, 3));
    prism.setIndex(faces);
    return prism;
  }

  // A group of prisms for a stage, and the function that shows those of an instant.
  function layer() {
    const group = new THREE.Group();
    let shown = '';
    function clear() {
      group.children.forEach((part) => { part.geometry.dispose(); part.material.dispose(); });
      group.clear();
    }
    function show(run, t) {
      const obstacles = known(run, t);
      const now = JSON.stringify(obstacles);
      if (now === shown) return;
      shown = now;
      clear();
      for (const obstacle of obstacles) {
        const color = COLORS[obstacle.sensor % COLORS.length], prism = geometry(obstacle);
        const faces = new THREE.Mesh(prism, new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.35, depthWrite: false }));
        const edges = new THREE.LineSegments(new THREE.EdgesGeometry(prism, 20), new THREE.LineBasicMaterial({ color }));
        faces.renderOrder = 3;
        group.add(faces, edges);
      }
    }
    return { group, show };
  }

  return { known, layer };
})();
