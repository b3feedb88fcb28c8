// The 3-D scene: meshes are uploaded once, a frame only sets poses and colours.
const Stage = (() => {
  const data = JSON.parse(document.getElementById('scene-data').textContent);
  const canvas = document.getElementById('canvas');

  const bytes = (text) => Uint8Array.from(atob(text || ''), (c) => c.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(bytes(text));
  const indices = (text) => new Uint32Array(bytes(text));

  for (const run of data.runs) {
    run.t = floats(run.t);
    for (const robot of run.robots) {
      for (const key of ['poses', 'tcp', 'override', 'speed', 'distance', 'nearest']) robot[key] = floats(robot[key]);
    }
    for (const region of run.regions) region.poses = floats(region.poses);
    run.objects = run.objects.map((poses) => poses && floats(poses));
  }

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
  } catch (error) {
    document.getElementById('no-webgl').hidden = false;
    return { data, show: () => {}, showRun: () => {} };
  }

  // Vertex normals are shared where faces meet at less than 40 degrees and split elsewhere: smooth surfaces, sharp edges.
  function geometry(mesh) {
    const v = floats(mesh.v);
    const index = indices(mesh.i);
    const faces = index.length / 3;
    const normals = new Float32Array(index.length);
    const around = new Map();
    const a = new THREE.Vector3(), b = new THREE.Vector3(), c = new THREE.Vector3();
    for (let f = 0; f < faces; f++) {
      a.fromArray(v, 3 * index[3 * f]);
      b.fromArray(v, 3 * index[3 * f + 1]).sub(a);
      c.fromArray(v, 3 * index[3 * f + 2]).sub(a);
      b.cross(c).toArray(normals, 3 * f);
      for (let k = 0; k < 3; k++) {
        const corner = index[3 * f + k];
        if (around.has(corner)) around.get(corner).push(f);
        else around.set(corner, [f]);
      }
    }
    const position = new Float32Array(9 * faces);
    const normal = new Float32Array(9 * faces);
    for (let f = 0; f < faces; f++) {
      a.fromArray(normals, 3 * f);
      const size = a.length();
      for (let k = 0; k < 3; k++) {
        const corner = index[3 * f + k];
        c.set(0, 0, 0);
        for (const other of around.get(corner)) {
          b.fromArray(normals, 3 * other);
          if (a.dot(b) >= 0.766 * size * b.length()) c.add(b);
        }
        c.normalize().toArray(normal, 9 * f + 3 * k);
        position.set(v.subarray(3 * corner, 3 * corner + 3), 9 * f + 3 * k);
      }
    }
    const out = new THREE.BufferGeometry();
    out.setAttribute('position', new THREE.BufferAttribute(position, 3));
    out.setAttribute('normal', new THREE.BufferAttribute(normal, 3));
    return out;
  }

  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(40, 1, 0.01, 200);
  camera.up.set(0, 0, 1);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f96, 2.3));
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(2, -3, 5);
  scene.add(sun);

  const solidMaterial = (color) => new THREE.MeshStandardMaterial({ color, roughness: 0.55, metalness: 0.08, side: THREE.DoubleSide });
  const glass = (color, opacity) => new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false });

  const robots = data.robots.map((robot) => robot.links.map((solids) => {
    const group = new THREE.Group();
    for (const solid of solids) group.add(new THREE.Mesh(geometry(solid.mesh), solidMaterial(solid.color)));
    scene.add(group);
    return group;
  }));
  const objects = data.objects.map((object) => {
    const thing = new THREE.Mesh(geometry(object.mesh), solidMaterial(object.color));
    scene.add(thing);
    return thing;
  });

  const regions = data.regions.map((region) => {
    const group = new THREE.Group();
    const solid = new THREE.Mesh(geometry(region.solid), new THREE.MeshStandardMaterial({ color: region.color, roughness: 0.7, transparent: true, opacity: 0.6 }));
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(solid.geometry, 40), new THREE.LineBasicMaterial({ color: region.color }));
    const shell = region.shell && new THREE.Mesh(geometry(region.shell), glass('#f2c230', 0.16));
    group.add(solid, edges);
    if (shell) { shell.renderOrder = 2; group.add(shell); }
    scene.add(group);
    return { group, solid, shell, edges };
  });

  // The bounding box of the view: robots, paths and regions, but not the patch of a half-space.
  function extent() {
    const low = new THREE.Vector3(Infinity, Infinity, Infinity), high = low.clone().negate(), p = new THREE.Vector3();
    const take = () => { low.min(p); high.max(p); };
    for (const run of data.runs) for (const robot of run.robots) {
      for (let i = 0; i + 2 < robot.tcp.length; i += 3) { p.fromArray(robot.tcp, i); take(); }
      const links = robot.poses.length / 7;
      for (let i = 0; i < links; i += Math.max(1, links >> 9)) { p.fromArray(robot.poses, 7 * i + 4); take(); }
    }
    const q = new THREE.Quaternion();
    data.regions.forEach((region, i) => {
      const poses = data.runs[0].regions[i].poses;
      const v = floats(region.solid.v);
      if (poses.length < 7) return;
      q.fromArray(poses, 0);
      for (let k = 0; k + 2 < v.length; k += 3) {
        p.fromArray(v, k);
        if (p.length() > 2.5) continue;
        p.applyQuaternion(q); p.x += poses[4]; p.y += poses[5]; p.z += poses[6];
        take();
      }
    });
    return low.x <= high.x ? { low, high } : { low: new THREE.Vector3(-1, -1, 0), high: new THREE.Vector3(1, 1, 1) };
  }

  const { low, high } = extent();
  const center = low.clone().add(high).multiplyScalar(0.5);
  const size = Math.max(0.5, low.distanceTo(high));
  // A tall canvas has a narrow field of view: increase the distance.
  const shape = canvas.parentElement.clientWidth / Math.max(1, canvas.parentElement.clientHeight);
  const away = size * 0.84 * Math.max(1, 1.15 / shape);
  camera.position.copy(center).add(new THREE.Vector3(0.78, -1.0, 0.62).multiplyScalar(away));
  camera.near = size / 200; camera.far = size * 40;
  const cells = Math.max(4, Math.ceil(size) * 2);
  const grid = new THREE.GridHelper(cells * 0.5, cells);
  grid.rotation.x = Math.PI / 2;
  grid.position.set(Math.round(center.x), Math.round(center.y), 0);
  scene.add(grid, new THREE.AxesHelper(0.25));

  const controls = new THREE.OrbitControls(camera, canvas);
  controls.target.copy(center);
  controls.addEventListener('change', () => request());

  // Paths are coloured by the override: red at 0, yellow at 0.5, green at 1.
  const overrideColor = (v, color = new THREE.Color()) => color.setHSL(0.33 * Math.min(1, Math.max(0, v)), 0.85, 0.45);
  const paths = data.runs.map((run) => {
    const group = new THREE.Group();
    for (const robot of run.robots) {
      const line = new THREE.BufferGeometry();
      const colors = new Float32Array(robot.tcp.length);
      robot.override.forEach((v, i) => overrideColor(v).toArray(colors, 3 * i));
      line.setAttribute('position', new THREE.BufferAttribute(robot.tcp, 3));
      line.setAttribute('color', new THREE.BufferAttribute(colors, 3));
      group.add(new THREE.Line(line, new THREE.LineBasicMaterial({ vertexColors: true })));
    }
    scene.add(group);
    return group;
  });
  const pointers = data.runs[0] ? data.runs[0].robots.map(() => {
    const line = new THREE.BufferGeometry();
    line.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6), 3));
    const needle = new THREE.Line(line, new THREE.LineBasicMaterial({ color: '#c2185b' }));
    needle.frustumCulled = false;
    const dot = new THREE.Mesh(new THREE.SphereGeometry(size * 0.006, 20, 12), new THREE.MeshBasicMaterial());
    scene.add(needle, dot);
    return { needle, dot };
  }) : [];

  const legend = document.getElementById('legend');
  const legendRows = data.regions.map((region) => {
    const row = document.createElement('div');
    const chip = document.createElement('i');
    const text = document.createElement('span');
    chip.style.background = region.color;
    text.textContent = `${region.name} (${region.kind})`;
    row.append(chip, text);
    legend.append(row);
    return { row, text };
  });

  const from = new THREE.Quaternion(), to = new THREE.Quaternion();
  // Between two frames: linear interpolation, shortest rotation.
  function place(object, poses, stride, offset, frame, next, part) {
    const a = frame * stride + offset, b = next * stride + offset;
    from.fromArray(poses, a);
    to.fromArray(poses, b);
    object.quaternion.slerpQuaternions(from, to, part);
    const mix = (k) => poses[a + k] + part * (poses[b + k] - poses[a + k]);
    object.position.set(mix(4), mix(5), mix(6));
  }

  const within = (spans, t) => spans.some(([, begin, end]) => t >= begin && t <= end);
  const isActive = (switches, t) => switches.reduce((on, [at, value]) => (at <= t + 1e-9 ? value : on), false);

  function showRegion(i, run, t, at) {
    const track = run.regions[i];
    if (!track) return;
    const { group, solid, shell, edges } = regions[i];
    if (track.moving) place(group, track.poses, 7, 0, at.frame, at.next, at.part);
    else place(group, track.poses, 7, 0, 0, 0, 0);
    const active = isActive(track.active, t), inside = within(track.inside, t), warned = within(track.warning, t);
    solid.material.opacity = active ? (inside ? 0.85 : 0.6) : 0.12;
    solid.material.emissive.set(active && inside ? data.regions[i].color : '#000000');
    edges.visible = active;
    if (shell) {
      shell.visible = active;
      shell.material.color.set(inside ? '#ff5030' : warned ? '#ff9a1f' : '#f2c230');
      shell.material.opacity = inside || warned ? 0.3 : 0.14;
    }
    const state = !active ? ' – off' : inside ? ' – inside' : warned ? ' – in warning zone' : '';
    const { row, text } = legendRows[i];
    row.className = active ? '' : 'off';
    text.textContent = `${data.regions[i].name} (${data.regions[i].kind})${state}`;
  }

  function showRobot(i, run, at) {
    const track = run.robots[i];
    if (!track || !pointers[i]) return;
    const links = robots[i] || [];
    if (track.poses.length) links.forEach((link, k) => place(link, track.poses, 7 * links.length, 7 * k, at.frame, at.next, at.part));
    // Tools that are not mounted.
    const absent = track.absent.reduce((now, [time, rows]) => (time <= run.t[at.frame] + 1e-6 ? rows : now), []);
    links.forEach((link, k) => { link.visible = !absent.includes(k); });
    const { needle, dot } = pointers[i];
    const mix = (k) => track.tcp[3 * at.frame + k] + at.part * (track.tcp[3 * at.next + k] - track.tcp[3 * at.frame + k]);
    dot.position.set(mix(0), mix(1), mix(2));
    overrideColor(track.override[at.frame], dot.material.color);
    const end = track.nearest.subarray(3 * at.frame, 3 * at.frame + 3);
    needle.visible = Number.isFinite(end[0]);
    if (needle.visible) {
      const corners = needle.geometry.attributes.position;
      corners.array.set([mix(0), mix(1), mix(2), ...end]);
      corners.needsUpdate = true;
    }
  }

  function show(runIndex, t, at) {
    const run = data.runs[runIndex];
    paths.forEach((path, i) => { path.visible = i === runIndex; });
    run.robots.forEach((_, i) => showRobot(i, run, at));
    regions.forEach((_, i) => showRegion(i, run, t, at));
    run.objects.forEach((poses, i) => { if (poses) place(objects[i], poses, 7, 0, at.frame, at.next, at.part); });
    request();
  }

  let waiting = false;
  function request() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      renderer.render(scene, camera);
    });
  }

  function theme() {
    const dark = window.matchMedia('(prefers-color-scheme: dark)').matches;
    scene.background = new THREE.Color(dark ? '#1a2027' : '#f4f6f8');
    grid.material.color.set(dark ? '#5a6673' : '#b9c2cb');
    grid.material.vertexColors = false;
    grid.material.needsUpdate = true;
    request();
  }
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', theme);
  theme();

  new ResizeObserver(() => {
    const { clientWidth: w, clientHeight: h } = canvas.parentElement;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(w, h, false);
    camera.aspect = w / Math.max(1, h);
    camera.updateProjectionMatrix();
    request();
  }).observe(canvas.parentElement);
  controls.update();

  return { data, show };
})();
