// The 3-D scene: meshes are uploaded once, an instant only sets poses and colours.
//
// `corners` answers points of the world that the view shall show; `lineCount` is the number of lines with a distance. Without
// WebGL all functions do nothing.
function createStage(corners, lineCount) {
  const canvas = byId('canvas'), holder = canvas.parentElement, labels = byId('labels');
  // Without a graphics card the processor draws: then smooth edges and shining surfaces cost more than half of the time. Smooth
  // edges must be chosen here; everything else adapts to the measured time, too.
  const isSoftware = (() => {
    const gl = document.createElement('canvas').getContext('webgl2');
    if (!gl) return false;
    const info = gl.getExtension('WEBGL_debug_renderer_info');
    const name = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
    gl.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(name);
  })();
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: !isSoftware });
  } catch (error) {
    byId('no-webgl').hidden = false;
    return { works: false, show: () => {}, fit: () => {}, look: () => {}, rendered: () => 0, onRender: () => {}, theme: () => {}, request: () => {}, flush: () => {}, add: () => {} };
  }

  const surfaces = Data.meshes.map(() => null);
  const surface = (index) => (surfaces[index] ||= Surfaces.levels(Data.meshes[index]));
  const meshOf = (index) => surface(index).fine;

  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(40, 1, 0.01, 200);
  camera.up.set(0, 0, 1);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f96, 2.3));
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.position.set(2, -3, 5);
  scene.add(sun);

  // Whether light is computed per corner instead of per pixel.
  let isSimple = isSoftware;
  const lit = (look, shine) => (isSimple ? Surfaces.perCorner(look) : new THREE.MeshStandardMaterial({ ...look, ...shine }));
  // Nobody sees the inside of a closed surface.
  const sides = ({ isClosed }) => (isClosed ? {} : { side: THREE.DoubleSide });
  const solidMaterial = (color, levels) => lit({ color, ...sides(levels) }, { roughness: 0.55, metalness: 0.08 });
  const glass = (color, opacity) => new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false });

  function setPose(object, p) {
    object.matrixAutoUpdate = false;
    object.matrix.set(p[0], p[1], p[2], p[9], p[3], p[4], p[5], p[10], p[6], p[7], p[8], p[11], 0, 0, 0, 1);
    object.matrixWorldNeedsUpdate = true;
  }

  // The borders of a grid's cells: along each axis a line through every crossing of the borders of the other two.
  function gridLines(axes) {
    const borders = axes.map(([from, to, count]) => Array.from({ length: count + 1 }, (_, i) => from + (to - from) * i / count));
    const points = [];
    for (let k = 0; k < 3; k++) {
      const [a, b] = [(k + 1) % 3, (k + 2) % 3];
      for (const u of borders[a]) for (const w of borders[b]) {
        for (const end of axes[k].slice(0, 2)) {
          const point = [0, 0, 0];
          [point[k], point[a], point[b]] = [end, u, w];
          points.push(...point);
        }
      }
    }
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
    return lines;
  }

  // Meshes with the levels of their details, and the size of details that are not seen, in pixels.
  const detailed = [];
  const robots = Data.robots.map((robot) => robot.solids.map((solid) => {
    const mesh = new THREE.Mesh(meshOf(solid.mesh), solidMaterial(solid.color, surface(solid.mesh)));
    scene.add(mesh);
    detailed.push({ mesh, levels: surface(solid.mesh), pixels: 1 });
    return { mesh, solid };
  }));
  const objects = Data.objects.map((object) => {
    const thing = new THREE.Mesh(meshOf(object.mesh), solidMaterial(object.color, surface(object.mesh)));
    scene.add(thing);
    detailed.push({ mesh: thing, levels: surface(object.mesh), pixels: 1 });
    return thing;
  });
  const regions = Data.regions.map((region) => {
    const group = new THREE.Group();
    const solid = new THREE.Mesh(meshOf(region.solid), lit({ color: region.color, transparent: true, opacity: 0.55 }, { roughness: 0.7 }));
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(solid.geometry, 40), new THREE.LineBasicMaterial({ color: region.color }));
    const shell = region.shell === null ? null : new THREE.Mesh(meshOf(region.shell), glass(region.color, 0.13));
    group.add(solid, edges);
    if (shell) { shell.renderOrder = 2; group.add(shell); }
    detailed.push({ mesh: solid, levels: surface(region.solid), pixels: 1 });
    // A shell is round everywhere.
    if (shell) detailed.push({ mesh: shell, levels: surface(region.shell), pixels: 4 });
    scene.add(group);
    const label = element('div', { className: 'label', textContent: region.name });
    label.style.borderColor = region.color;
    labels.append(label);
    return { group, solid, shell, edges, label };
  });

  const shields = Data.shields.map((shield) => {
    const glassy = new THREE.Mesh(meshOf(shield.mesh), glass(shield.color, 0.3));
    glassy.renderOrder = 3;
    glassy.visible = shield.active;
    setPose(glassy, shield.pose);
    scene.add(glassy);
    return glassy;
  });

  const shieldIsOn = Data.shields.map((shield) => shield.active);

  // A shield of its own, shaded so that its opening is seen; in the world.
  function shaded(mesh, color) {
    const solid = new THREE.Mesh(Surfaces.geometry(mesh), lit({ color, transparent: true, opacity: 0.55 }, { roughness: 0.6 }));
    solid.renderOrder = 3;
    return solid;
  }

  for (const grid of Data.grids) {
    const lines = new THREE.LineSegments(gridLines(grid.axes), new THREE.LineBasicMaterial({ color: grid.color, transparent: true, opacity: 0.6 }));
    setPose(lines, grid.pose);
    scene.add(lines);
  }

  // Lines between two points, with the distance.
  const lines = Array.from({ length: lineCount }, () => {
    const ends = new THREE.BufferGeometry();
    ends.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6), 3));
    const material = new THREE.LineBasicMaterial({ color: '#c2185b', depthTest: false });
    const line = new THREE.Line(ends, material);
    line.frustumCulled = false;
    line.renderOrder = 5;
    const dots = [0, 1].map(() => new THREE.Mesh(new THREE.SphereGeometry(1, 12, 8), new THREE.MeshBasicMaterial({ color: '#c2185b', depthTest: false })));
    dots.forEach((dot) => { dot.renderOrder = 6; scene.add(dot); });
    scene.add(line);
    const label = element('div', { className: 'label line' });
    labels.append(label);
    return { line, dots, label };
  });

  const overrideColor = (v, color = new THREE.Color()) => color.setHSL(0.33 * Math.min(1, Math.max(0, v)), 0.85, 0.45);
  const tcpDots = Data.robots.map(() => {
    const dot = new THREE.Mesh(new THREE.SphereGeometry(1, 12, 8), new THREE.MeshBasicMaterial());
    scene.add(dot);
    return dot;
  });

  // Corners of the box of a mesh at a pose.
  function boxCorners(mesh, p) {
    if (!mesh.box) {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      mesh.v.forEach((x, k) => { low[k % 3] = Math.min(low[k % 3], x); high[k % 3] = Math.max(high[k % 3], x); });
      mesh.box = { low, high };
    }
    const { low, high } = mesh.box;
    const at = (k) => [k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]];
    return Array.from({ length: 8 }, (_, k) => new THREE.Vector3(...Kinematics.apply(p, at(k))));
  }
  const points = corners(boxCorners);
  if (!points.length) points.push(new THREE.Vector3(-1, -1, 0), new THREE.Vector3(1, 1, 1));
  const bounds = points.reduce(({ low, high }, p) => ({ low: low.min(p), high: high.max(p) }), { low: points[0].clone(), high: points[0].clone() });
  const center = bounds.low.clone().add(bounds.high).multiplyScalar(0.5);
  const size = Math.max(0.5, bounds.low.distanceTo(bounds.high));
  const cells = Math.max(4, Math.ceil(size) * 2);
  const grid = new THREE.GridHelper(cells * 0.5, cells);
  grid.rotation.x = Math.PI / 2;
  grid.position.set(Math.round(center.x), Math.round(center.y), 0);
  scene.add(grid, new THREE.AxesHelper(0.08 * size));
  tcpDots.forEach((dot) => dot.scale.setScalar(size * 0.005));
  lines.forEach(({ dots }) => dots.forEach((dot) => dot.scale.setScalar(size * 0.004)));

  const controls = new THREE.OrbitControls(camera, canvas);
  let isFitted = true;
  controls.addEventListener('start', () => { isFitted = false; });
  controls.addEventListener('change', () => request());

  // Puts the camera where every corner is just in view: in its own axes, each pair of sides of the view bounds the position.
  // The direction in which it looks when the view is fitted.
  const oblique = [-0.78, 1.0, -0.62];
  let direction = oblique;

  // Looks along a direction.
  function look(along) {
    direction = along;
    const towards = new THREE.Vector3(...along).normalize();
    const right = towards.clone().cross(camera.up).normalize(), up = right.clone().cross(towards);
    const tall = 0.92 * Math.tan((camera.fov * Math.PI) / 360), wide = tall * camera.aspect;
    // |x − cx| ≤ slope · (z − cz) for every point: twice a bound of slope · cz ± cx.
    const limit = (axis, slope) => {
      const least = (sign) => Math.min(...points.map((p) => slope * p.dot(towards) + sign * p.dot(axis)));
      const [less, more] = [least(-1), least(1)];
      return { c: (more - less) / 2, z: (less + more) / (2 * slope) };
    };
    const x = limit(right, wide), y = limit(up, tall), z = Math.min(x.z, y.z);
    camera.position.set(0, 0, 0).addScaledVector(right, x.c).addScaledVector(up, y.c).addScaledVector(towards, z);
    const depth = center.clone().sub(camera.position).dot(towards);
    controls.target.copy(camera.position).addScaledVector(towards, Math.max(0.1, depth));
    camera.near = size / 500;
    camera.far = size * 40;
    camera.updateProjectionMatrix();
    isFitted = true;
    controls.update();
    request();
  }
  const fit = () => look(oblique);

  // Brings a ball of the world into view, seen from the same side.
  function focus(middle, radius) {
    const towards = camera.getWorldDirection(new THREE.Vector3());
    controls.target.set(...middle);
    camera.position.set(...middle).addScaledVector(towards, -radius / Math.sin((camera.fov * Math.PI) / 360));
    isFitted = false;
    controls.update();
    request();
  }

  // A label above a point of the world, moved up or down where it would cover another one; hidden where the point is out of view.
  function put(label, point, placed) {
    const p = point.clone().project(camera);
    label.hidden = Math.abs(p.x) > 1 || Math.abs(p.y) > 1 || p.z > 1;
    if (label.hidden) return;
    const w = label.offsetWidth, h = label.offsetHeight;
    const left = Math.min(Math.max(((p.x + 1) / 2) * holder.clientWidth - w / 2, 0), Math.max(0, holder.clientWidth - w));
    const above = ((1 - p.y) / 2) * holder.clientHeight - 1.2 * h;
    const covers = (top) => placed.some((o) => left < o.left + o.w && o.left < left + w && top < o.top + o.h && o.top < top + h);
    const shifts = [0, 1, -1, 2, -2, 3, -3].map((n) => above + n * (h + 1));
    const top = shifts.find((y) => !covers(y)) ?? above;
    placed.push({ left, top, w, h });
    label.style.transform = `translate(${left}px, ${top}px)`;
  }

  let shown = null, alone = null;
  function placeLabels() {
    if (!shown) return;
    const placed = [];
    lines.forEach(({ label }, i) => {
      const line = shown.lines[i];
      label.hidden = !line || alone !== null;
      if (!label.hidden) put(label, new THREE.Vector3(...line.onA).add(new THREE.Vector3(...line.onB)).multiplyScalar(0.5), placed);
    });
    regions.forEach(({ label }, i) => {
      const p = shown.regions[i].pose;
      if (alone !== null) label.hidden = true;
      else put(label, new THREE.Vector3(p[9], p[10], p[11]), placed);
    });
  }

  function showRegion(i, { pose, active, inside, warned, state }) {
    const { group, solid, shell, edges, label } = regions[i];
    setPose(group, pose);
    solid.material.opacity = active ? (inside ? 0.85 : 0.55) : 0.1;
    solid.material.emissive.set(active && inside ? Data.regions[i].color : '#000000');
    edges.visible = active;
    if (shell) { shell.visible = active; shell.material.opacity = inside || warned ? 0.26 : 0.11; }
    group.visible = alone === null;
    label.textContent = Data.regions[i].name + (state ? ` (${state})` : '');
    label.classList.toggle('off', !active);
  }

  function showLine(i, shownLine) {
    const { line, dots, label } = lines[i];
    line.visible = Boolean(shownLine);
    dots.forEach((dot) => { dot.visible = Boolean(shownLine); });
    if (!shownLine) return;
    const ends = line.geometry.attributes.position;
    ends.array.set([...shownLine.onA, ...shownLine.onB]);
    ends.needsUpdate = true;
    dots[0].position.set(...shownLine.onA);
    dots[1].position.set(...shownLine.onB);
    label.textContent = shownLine.text;
  }

  // Shows an instant: per robot { links, absent, tcp, level }, the level from 0 to 1 or null; per object { pose }; per region
  // { pose, active, inside, warned, state }; per line { onA, onB, text } or null; per shield whether it is on, if that changes.
  function show(instant) {
    shown = instant;
    robots.forEach((solids, i) => {
      const { links, absent, tcp, level } = instant.robots[i];
      solids.forEach(({ mesh, solid }) => {
        mesh.visible = alone === null && !absent.includes(solid.link);
        setPose(mesh, Kinematics.multiply(links[solid.link], solid.pose));
      });
      tcpDots[i].visible = alone === null && Boolean(tcp);
      if (tcp) tcpDots[i].position.set(...tcp);
      overrideColor(level ?? 1, tcpDots[i].material.color);
    });
    lines.forEach((_, i) => showLine(i, alone === null ? instant.lines[i] : null));
    objects.forEach((object, i) => {
      object.visible = alone === null || alone === i;
      setPose(object, instant.objects[i].pose);
    });
    instant.regions.forEach((region, i) => showRegion(i, region));
    instant.shields?.forEach((isOn, i) => { shieldIsOn[i] = isOn; });
    shields.forEach((shield, i) => { shield.visible = alone === null && shieldIsOn[i]; });
    request();
  }

  // Shows an object alone, by its index; null shows everything again.
  function isolate(object) {
    alone = object;
    if (shown) show(shown);
  }

  // While a picture takes longer than at 30 per second, surfaces are drawn simpler, then pixels larger; finer ones are tried when
  // pictures have been quick for long, each time later. When the scene rests, pixels are as fine as the screen's.
  const COARSEST = 0.5, SLOW_MS = 33.5, QUICK_MS = 25, LONGEST_MS = 100, COUNTED = 15, REST_MS = 500;
  const finest = () => Math.min(2, window.devicePixelRatio || 1);
  let ratio = finest(), counted = 0, total = 0, quick = 0, patience = 4, resting = 0;
  function setRatio(to) {
    ratio = Math.min(finest(), Math.max(COARSEST, to));
    counted = 0;
    total = 0;
    quick = 0;
    renderer.setPixelRatio(ratio);
  }
  function simplify() {
    isSimple = true;
    scene.traverse((thing) => {
      if (!thing.material?.isMeshStandardMaterial) return;
      const { color, emissive, opacity, transparent, side } = thing.material;
      thing.material.dispose();
      thing.material = Surfaces.perCorner({ color, emissive, opacity, transparent, side });
    });
  }
  // The mean duration of some pictures, ms, has been measured.
  function decide(mean) {
    quick = mean < QUICK_MS ? quick + 1 : 0;
    if (mean > SLOW_MS && !isSimple) simplify();
    else if (mean > SLOW_MS && ratio > COARSEST) setRatio(ratio * 0.8);
    else if (quick >= patience && ratio < finest()) { patience *= 2; setRatio(ratio * 1.25); }
  }
  function adapt() {
    const begin = performance.now();
    requestAnimationFrame(() => {
      counted += 1;
      // A page in the background gets no pictures: one of them says little.
      total += Math.min(LONGEST_MS, performance.now() - begin);
      if (counted < COUNTED) return;
      decide(total / counted);
      counted = 0;
      total = 0;
    });
    clearTimeout(resting);
    if (ratio < finest()) resting = setTimeout(() => { if (!pending) { setRatio(finest()); request(); } }, REST_MS);
  }

  // Details that are not seen are not drawn.
  const eye = new THREE.Vector3();
  function chooseDetails() {
    scene.updateMatrixWorld();
    const slope = (2 * Math.tan((camera.fov * Math.PI) / 360)) / canvas.height;
    for (const { mesh, levels, pixels } of detailed) {
      const distance = eye.copy(levels.center).applyMatrix4(mesh.matrixWorld).distanceTo(camera.position) - levels.radius;
      mesh.geometry = levels.at(pixels * slope * Math.max(camera.near, distance));
    }
  }

  let pending = 0, rendered = 0, beforeRender = () => {};
  function render() {
    pending = 0;
    rendered += 1;
    beforeRender();
    chooseDetails();
    renderer.render(scene, camera);
    adapt();
    placeLabels();
  }
  function request() {
    pending ||= requestAnimationFrame(render);
  }
  // Draws what has been requested now, for those who are called once per picture: not one picture later.
  function flush() {
    if (!pending) return;
    cancelAnimationFrame(pending);
    render();
  }

  function theme() {
    const chosen = document.documentElement.dataset.theme;
    const dark = chosen ? chosen === 'dark' : window.matchMedia('(prefers-color-scheme: dark)').matches;
    scene.background = new THREE.Color(dark ? '#1a2027' : '#f4f6f8');
    grid.material.color.set(dark ? '#5a6673' : '#b9c2cb');
    grid.material.vertexColors = false;
    grid.material.needsUpdate = true;
    lines.forEach(({ line, dots }) => [line, ...dots].forEach((part) => part.material.color.set(dark ? '#ff7ab0' : '#c2185b')));
    request();
  }
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', theme);
  theme();

  new ResizeObserver(() => {
    const { clientWidth: w, clientHeight: h } = holder;
    renderer.setPixelRatio(ratio);
    renderer.setSize(w, h, false);
    camera.aspect = w / Math.max(1, h);
    camera.updateProjectionMatrix();
    if (isFitted) look(direction); else request();
  }).observe(holder);

  return {
    works: true, show, fit, look, focus, isolate, theme, request, flush, overrideColor, camera, canvas, controls, size,
    add: (thing) => scene.add(thing),
    remove: (thing) => scene.remove(thing),
    shaded,
    rendered: () => rendered,
    pixelRatio: () => ratio,
    triangles: () => renderer.info.render.triangles,
    onRender: (f) => { beforeRender = f; },
  };
}
