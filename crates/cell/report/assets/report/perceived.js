// Obstacles that sensors see, as translucent prisms and in words: what the robots knew at an instant, not where the obstacles
// were. A prism has the outline with the uncertainty of the sensor; it is paler while the obstacle is hidden.
const Perceived = (() => {
  const COLORS = ['#00838f', '#ad6c00', '#5d6d1e'];

  // What every sensor of a run knew at time t: its last record that was usable by then.
  function known(run, t) {
    return run.sensors.flatMap((sensor, index) => {
      const record = sensor.records.reduce((last, one) => (one.t <= t + 1e-9 ? one : last), null);
      return record ? record.obstacles.map((o) => ({ ...o, sensor: index, name: `${sensor.name}#${o.id}`, since: record.t })) : [];
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
      const now = JSON.stringify([run.label, obstacles]);
      if (now === shown) return;
      shown = now;
      clear();
      for (const obstacle of obstacles) {
        const color = COLORS[obstacle.sensor % COLORS.length], prism = geometry(obstacle);
        const faces = new THREE.Mesh(prism, new THREE.MeshBasicMaterial({ color, transparent: true, opacity: obstacle.seen ? 0.35 : 0.15, depthWrite: false }));
        const edges = new THREE.LineSegments(new THREE.EdgesGeometry(prism, 20), new THREE.LineBasicMaterial({ color }));
        faces.renderOrder = 3;
        faces.name = obstacle.name;
        group.add(faces, edges);
      }
    }
    // The prisms that are drawn, with the corners of their boxes, m.
    function drawn() {
      return group.children.filter((part) => part.name).map((part) => {
        part.geometry.computeBoundingBox();
        const { min, max } = part.geometry.boundingBox;
        return { name: part.name, from_m: min.toArray(), to_m: max.toArray(), opacity: part.material.opacity };
      });
    }
    return { group, show, drawn };
  }

  // What every sensor sees at an instant, in words below the scene.
  function list(box, run, t) {
    const thin = run.sensors.filter((sensor) => sensor.every > 1).map((sensor) => `one of ${sensor.every} changes of ${sensor.name} is shown`);
    const words = (o) => {
      const kind = o.kind || 'of unknown kind', hidden = o.seen ? '' : ', hidden: kept where it was';
      return `${o.name} ${kind}, counts as ${o.height.toFixed(2)} m high from ${o.bottom.toFixed(2)} m${hidden}`;
    };
    const row = (o) => {
      const swatch = element('i');
      swatch.style.background = swatch.style.borderColor = COLORS[o.sensor % COLORS.length];
      return element('span', {}, swatch, words(o));
    };
    const obstacles = known(run, t);
    box.hidden = !run.sensors.length;
    const none = obstacles.length || box.hidden ? [] : [element('span', { textContent: 'no obstacle is seen' })];
    box.replaceChildren(...obstacles.map(row), ...none, ...thin.map((text) => element('span', { textContent: text })));
  }

  return { known, layer, list };
})();
