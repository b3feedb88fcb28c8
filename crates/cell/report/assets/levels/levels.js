// Choice of a level: the slider, the table and the arrow keys; sliders for the joints; the boxes around the robot.
const robot = Data.robots[0];
const q = [...Data.rest];
// Numbers of a box in its array: link, pose, half extents.
const WIDTH = 11;

// The boxes of a level by link: eight corners each, in the frame of the link.
function boxesByLink(values) {
  const byLink = new Map();
  for (let at = 0; at < values.length; at += WIDTH) {
    const link = Math.round(values[at]), pose = Kinematics.fromValues(values, at + 1);
    const [x, y, z] = values.slice(at + 8, at + 11);
    const corners = Array.from({ length: 8 }, (_, k) => Kinematics.apply(pose, [k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z]));
    if (!byLink.has(link)) byLink.set(link, []);
    byLink.get(link).push(corners);
  }
  return byLink;
}

const hasWhole = Data.levels[0].name === 'L1';
const ofL2 = boxesByLink(Data.levels.find((level) => level.name === 'L2').boxes);

// The box of L1 around the boxes of L2, as queries build it.
function wholeRobot(links) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const [link, boxes] of ofL2) {
    for (const point of boxes.flat().map((corner) => Kinematics.apply(links[link], corner))) {
      point.forEach((x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); });
    }
  }
  return Array.from({ length: 8 }, (_, k) => [k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]]);
}

const stage = createStage((boxCorners) => {
  const links = Kinematics.links(robot, q);
  const points = robot.solids.flatMap((s) => boxCorners(Data.meshes[s.mesh], Kinematics.multiply(links[s.link], s.pose)));
  return points.concat(wholeRobot(links).map((p) => new THREE.Vector3(...p)));
}, 0);

// A glassy mesh of boxes with edges, in the frame of a link.
const FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
const EDGES = [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];
function glass(boxes, color) {
  const positions = (corners) => {
    const out = new THREE.BufferGeometry();
    out.setAttribute('position', new THREE.BufferAttribute(new Float32Array(boxes.flatMap((box) => corners.flatMap((k) => box[k]))), 3));
    return out;
  };
  const triangles = FACES.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  const opacity = boxes.length > 8 ? 0.1 : 0.18;
  const faces = new THREE.Mesh(positions(triangles), new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide }));
  const edges = new THREE.LineSegments(positions(EDGES.flat()), new THREE.LineBasicMaterial({ color }));
  faces.renderOrder = 2;
  faces.frustumCulled = edges.frustumCulled = false;
  const group = new THREE.Group();
  group.add(faces, edges);
  group.matrixAutoUpdate = false;
  return group;
}

// The hue of a link: neighbours differ.
const hue = (link) => new THREE.Color().setHSL((0.58 + 0.381966 * link) % 1, 0.75, 0.45);

// Per level: its links with their boxes, made when the level is first shown. L1 is made anew for every pose.
const drawn = new Map();
let whole = null, chosen = Data.levels.findIndex((level) => level.name === 'L2');
function draw(level) {
  const links = [...boxesByLink(Data.levels[level].boxes)].map(([link, boxes]) => ({ link, group: glass(boxes, hue(link)) }));
  links.forEach(({ group }) => stage.add(group));
  return links;
}

const number = (value) => value.toLocaleString('en', { maximumFractionDigits: 2 });
const [slider, output, rows] = [byId('level'), byId('shown'), [...byId('levels').rows]];

function show() {
  const links = Kinematics.links(robot, q);
  stage.show({ robots: [{ links, absent: [], tcp: null, level: null }], objects: [], regions: [], lines: [] });
  const level = Data.levels[chosen];
  if (stage.works) {
    if (whole) { whole.removeFromParent(); whole.traverse((part) => part.geometry?.dispose()); whole = null; }
    if (level.name === 'L1') {
      whole = glass([wholeRobot(links)], hue(0));
      stage.add(whole);
    } else if (!drawn.has(chosen)) {
      drawn.set(chosen, draw(chosen));
    }
    for (const [at, parts] of drawn) {
      for (const { link, group } of parts) {
        const p = links[link];
        group.visible = at === chosen;
        group.matrix.set(p[0], p[1], p[2], p[9], p[3], p[4], p[5], p[10], p[6], p[7], p[8], p[11], 0, 0, 0, 1);
        group.matrixWorldNeedsUpdate = true;
      }
    }
    stage.request();
  }
  // The bound of L1 holds at rest only.
  const isMoved = level.name === 'L1' && q.some((value, k) => value !== Data.rest[k]);
  const bound = isMoved ? '' : `, protruding ${number(1000 * level.protrusion_m)} mm at most`;
  output.textContent = level.name === 'L3' ? 'L3: the exact geometry, no boxes' : `${level.name}: ${level.count} ${level.count === 1 ? 'box' : 'boxes'}${bound}`;
  slider.value = chosen;
  slider.setAttribute('aria-valuetext', output.textContent);
  rows.forEach((row, k) => row.setAttribute('aria-current', String(k === chosen)));
}

function choose(level) {
  chosen = Math.max(0, Math.min(Data.levels.length - 1, level));
  show();
}

slider.max = Data.levels.length - 1;
slider.addEventListener('input', () => choose(Number(slider.value)));
rows.forEach((row, k) => row.addEventListener('click', () => choose(k)));
byId('fit').addEventListener('click', () => stage.fit());
document.addEventListener('keydown', (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || event.target.closest?.('input')) return;
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 };
  if (event.key in steps) choose(chosen + steps[event.key]);
  else if (event.key === 'f' || event.key === 'F') stage.fit();
  else return;
  event.preventDefault();
});

// Sliders of the joints.
const rounded = (value, digits) => (Number(value.toFixed(digits)) + 0).toFixed(digits);
if (robot.sliders.length) {
  const set = element('fieldset', {}, element('legend', { textContent: 'joints' }));
  byId('joints').append(set);
  robot.sliders.forEach((joint, k) => {
    const id = `joint-${k}`;
    const input = element('input', { type: 'range', id, step: 'any', min: joint.lower, max: joint.upper, value: q[k] });
    const text = element('output');
    text.htmlFor = id;
    const tell = () => {
      text.textContent = joint.slides ? `${rounded(1000 * q[k], 1)} mm` : `${rounded((180 * q[k]) / Math.PI, 2)}°`;
      input.setAttribute('aria-valuetext', text.textContent);
    };
    input.addEventListener('input', () => { q[k] = Number(input.value); tell(); show(); });
    tell();
    set.append(element('label', { htmlFor: id, textContent: joint.name }), input, text);
  });
}

show();
window.elbowroom = {
  state: () => ({ level: Data.levels[chosen].name, shown: output.textContent, whole: hasWhole ? wholeRobot(Kinematics.links(robot, q)) : null }),
  rendered: () => stage.rendered(),
};
document.documentElement.dataset.ready = 'true';
