// A person draws the target of a virtual fixture on an object: points are asked of the program, so that they are exact.
const Draw = (() => {
  if (!Data.draws) return { state: () => null };
  const MOVED_PX = 5; // a press that moves farther turns the view
  const { stage, ray } = Scene;
  const ids = ['object', 'kind', 'name', 'tool', 'width', 'offset', 'depth', 'flare', 'tolerance', 'radius'];
  const field = Object.fromEntries(ids.map((id) => [id, byId(`draw-${id}`)]));
  const [place, undo, clear, look, preview, write] = ['place', 'undo', 'clear', 'look', 'preview', 'write'].map((id) => byId(`draw-${id}`));
  const [message, table, count] = ['message', 'table', 'count'].map((id) => byId(`draw-${id}`));
  byId('draw-card').hidden = false;
  let points = [], along = [], isPlacing = false, isBusy = false, report = null, written = false, known = null, asked = 0;

  // Sends a request; its answer, or an error with the words of the program.
  async function ask(path, body) {
    const headers = { Authorization: `Bearer ${Link.token}`, ...(body ? { 'Content-Type': 'application/json' } : {}) };
    const response = await fetch(path, { method: body ? 'POST' : 'GET', headers, body: body && JSON.stringify(body) }).catch(() => null);
    if (!response) throw new Error('The program does not answer.');
    if (!response.ok) {
      const refused = await response.json().catch(() => ({ error: `The program refuses this (${response.status}).` }));
      throw new Error(refused.help ? `${refused.error}\nwrite: ${refused.help}` : refused.error);
    }
    return response;
  }

  function say(text, kind = '') {
    message.textContent = text;
    message.dataset.kind = kind;
  }

  const needed = () => ({ line: 2, area: 3, drill: 1, faces_within: 1 }[field.kind.value]);
  const isLine = () => needed() > 1;
  const millimetres = (id) => (field[id].value === '' ? null : Number(field[id].value) / 1000);
  const inward = () => points[0].outward.map((x) => -x);
  const depth = () => millimetres('depth') ?? known.default.depth_m;

  function target() {
    const all = points.map((p) => p.point_m);
    switch (field.kind.value) {
      case 'drill': return { drill: { at_m: all[0], axis: inward(), depth_m: depth() } };
      case 'faces_within': return { faces_within: { at_m: all[0], radius_m: millimetres('radius') ?? 0 } };
      default: return { [field.kind.value]: all };
    }
  }

  const fixture = () => ({
    name: field.name.value.trim(), protects: field.object.value, target: target(), tool: field.tool.value || null,
    width_m: millimetres('width'), offset_m: millimetres('offset'), depth_m: field.kind.value === 'drill' ? null : millimetres('depth'),
    flare_rad: field.flare.value === '' ? null : Number(field.flare.value) * Units.DEGREE, tolerance_m: millimetres('tolerance'),
  });

  // The ball around the chosen object.
  function ball() {
    const object = Data.objects.find((o) => o.name === field.object.value), { v } = Data.meshes[object.mesh];
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    v.forEach((x, k) => { low[k % 3] = Math.min(low[k % 3], x); high[k % 3] = Math.max(high[k % 3], x); });
    const middle = low.map((x, k) => (x + high[k]) / 2);
    return { middle: Kinematics.apply(object.pose, middle), radius: Math.hypot(...low.map((x, k) => high[k] - x)) / 2 };
  }
  function lookAt() {
    const { middle, radius } = ball();
    stage.focus(middle, radius);
  }

  function show() {
    const all = points.map((p) => p.point_m), kind = field.kind.value;
    const drill = kind === 'drill' && points.length ? [all[0], all[0].map((x, k) => x + inward()[k] * Math.max(depth(), 0.005))] : null;
    DrawScene.show({ points: all, size: ball().radius * 0.014, along, drill, radius: kind === 'faces_within' ? millimetres('radius') : null });
    const last = all.length ? `, the last at ${all[all.length - 1].map((x) => Units.rounded(1000 * x, 2)).join(', ')} mm` : '';
    count.textContent = `${all.length} of ${needed()}${isLine() ? ' or more' : ''} points${last}`;
    undo.disabled = clear.disabled = !all.length;
    preview.disabled = write.disabled = isBusy || all.length < needed();
    place.setAttribute('aria-pressed', String(isPlacing));
    byId('draw-radius-label').hidden = kind !== 'faces_within';
  }

  // The drawn target has changed: what was previewed is another one.
  async function changed(note = '') {
    report = null;
    written = false;
    table.hidden = true;
    DrawScene.showShield(null);
    say(note);
    const mine = ++asked;
    if (!isLine() || points.length < 2) along = [];
    show();
    if (!isLine() || points.length < 2) return;
    if (!(millimetres('width') > 0)) { say('The width of the opening is more than 0.', 'bad'); return; }
    try {
      const closed = field.kind.value === 'area' && points.length > 2;
      const body = { object: field.object.value, points_m: points.map((p) => p.point_m), closed, width_m: millimetres('width'), tolerance_m: millimetres('tolerance') };
      const answer = await (await ask('/draw/line', body)).json();
      if (mine !== asked) return;
      along = answer.points_m;
    } catch (error) {
      if (mine !== asked) return;
      along = [];
      say(error.message, 'bad');
    }
    show();
  }

  // Clicks are answered one after the other, so that points keep their order; not those before an undo or a new target.
  let picks = Promise.resolve(), version = 0;
  function add(x, y) {
    const eye = ray(x, y), mine = version;
    picks = picks.then(() => pick(eye, mine));
  }
  async function pick({ origin, along: direction }, mine) {
    try {
      const body = { object: field.object.value, origin_m: origin.toArray(), direction: direction.toArray() };
      const hit = await (await ask('/draw/pick', body)).json();
      if (mine !== version) return;
      if (!hit.point_m) { say(`There is no point of ${field.object.value} under the pointer.`, 'bad'); return; }
      if (isLine() && points.length >= known.most_points) { say(`A target has at most ${known.most_points} points.`, 'bad'); return; }
      points = isLine() ? [...points, hit] : [hit];
      await changed();
    } catch (error) { say(error.message, 'bad'); }
  }

  // Keeps the first points only.
  function keep(number) {
    version += 1;
    points = points.slice(0, number);
    changed();
  }
  const takeBack = () => keep(Math.max(0, points.length - 1));

  function setPlacing(on) {
    isPlacing = on;
    stage.canvas?.parentElement.classList.toggle('draws', on);
    Drag.enable(!on);
    isolate();
    show();
  }

  // While points are placed, nothing hides the object.
  function isolate() {
    if (stage.works) stage.isolate(isPlacing ? Data.objects.findIndex((o) => o.name === field.object.value) : null);
  }

  const summary = (made) => {
    const parts = [`${made.triangles} triangles`, made.narrowest_m === null ? null : `opening at least ${Units.millimetres(made.narrowest_m)} wide`];
    if (made.components > 1) parts.push(`${made.components} separate parts`);
    const reach = made.reachable === null ? 'No tool is named: whether one passes is not examined.'
      : made.reachable ? `The tool, ${Units.millimetres(made.tool_width_m)} wide, reaches the target.`
        : `The tool, ${Units.millimetres(made.tool_width_m)} wide, does not reach the target at ${made.blocked_at_m.map((x) => Units.rounded(1000 * x, 2)).join(', ')} mm: a larger width or flare, or a narrower tool.`;
    return `Shield: ${parts.filter(Boolean).join(', ')}.\n${reach}`;
  };

  // Carries out a request that takes a while; meanwhile the buttons are off.
  async function during(text, work) {
    isBusy = true;
    say(text);
    show();
    try { await work(asked); } catch (error) { say(error.message, 'bad'); }
    isBusy = false;
    show();
  }

  function showMade(made) {
    report = made.report;
    table.textContent = made.table;
    table.hidden = false;
    return summary(report);
  }

  const makePreview = () => during('The shield is being made.', async (mine) => {
    const { data, mesh } = unpack(await (await ask('/draw/preview', fixture())).arrayBuffer());
    if (mine !== asked) return;
    DrawScene.showShield(mesh(data.mesh));
    say(showMade(data), data.report.reachable === false ? 'bad' : 'good');
  });

  const writeFile = () => during('The shield is being made.', async (mine) => {
    const done = await (await ask('/draw/write', fixture())).json();
    await describe();
    if (mine !== asked) return;
    written = true;
    say(`${done.replaces ? 'The target is replaced' : 'The fixture is added'} in ${known.file}.\n${showMade(done)}`, 'good');
  });

  // If the name is of a fixture of the file, its dimensions are shown; what is to be said about that.
  function choose() {
    const found = known.fixtures.find((f) => f.name === field.name.value.trim());
    if (!found || !found.settings) return '';
    const { width_m, offset_m, depth_m, flare_rad, tolerance_m } = found.settings;
    Object.entries({ width: width_m, offset: offset_m, depth: depth_m, tolerance: tolerance_m }).forEach(([id, metres]) => { field[id].value = Number((1000 * metres).toFixed(6)); });
    field.flare.value = Number((flare_rad / Units.DEGREE).toFixed(6));
    return `${found.name} is in the file: its target is replaced.`;
  }

  async function describe() {
    known = await (await ask('/draw')).json();
    const { width_m, flare_rad, ...lengths } = known.default;
    for (const [key, metres] of Object.entries(lengths)) field[key.slice(0, -2)].placeholder = `${1000 * metres}`;
    field.flare.placeholder = `${flare_rad / Units.DEGREE}`;
    byId('draw-names').replaceChildren(...known.fixtures.map((f) => element('option', { value: f.name })));
    const names = new Set([...known.fixtures.map((f) => f.name), ...known.guides]);
    let number = 1;
    while (names.has(`cut_${number}`)) number += 1;
    if (!field.name.value) field.name.value = `cut_${number}`;
  }

  function listen() {
    const box = stage.canvas.parentElement;
    let pressed = null;
    const at = ({ clientX, clientY }) => { const { left, top } = stage.canvas.getBoundingClientRect(); return [clientX - left, clientY - top]; };
    box.addEventListener('pointerdown', (event) => { pressed = isPlacing && event.isPrimary && event.button === 0 ? at(event) : null; }, { capture: true });
    box.addEventListener('pointerup', (event) => {
      const [x, y] = at(event), from = pressed;
      pressed = null;
      if (from && isPlacing && Math.hypot(x - from[0], y - from[1]) < MOVED_PX) add(x, y);
    }, { capture: true });
    box.addEventListener('pointercancel', () => { pressed = null; }, { capture: true });
  }

  async function begin() {
    try { await describe(); } catch (error) { say(error.message, 'bad'); return; }
    if (!known.objects.length) { say('The cell has no object to draw on.', 'bad'); return; }
    field.object.append(...known.objects.map(({ name, kind }) => element('option', { value: name, textContent: `${name} (${kind})` })));
    field.tool.append(element('option', { value: '', textContent: 'none' }), ...known.tools.map((tool) => element('option', { value: tool, textContent: tool })));
    if (known.tools.length) field.tool.value = known.tools[0];
    field.object.addEventListener('change', () => { keep(0); isolate(); if (stage.works) lookAt(); });
    look.addEventListener('click', lookAt);
    field.kind.addEventListener('change', () => keep(isLine() ? points.length : 1));
    for (const id of ['width', 'offset', 'depth', 'flare', 'tolerance', 'radius', 'tool']) field[id].addEventListener('change', () => changed());
    field.name.addEventListener('change', () => changed(choose()));
    place.addEventListener('click', () => setPlacing(!isPlacing));
    undo.addEventListener('click', takeBack);
    clear.addEventListener('click', () => keep(0));
    preview.addEventListener('click', makePreview);
    write.addEventListener('click', writeFile);
    document.addEventListener('keydown', (event) => {
      const isUndo = (event.ctrlKey || event.metaKey) && !event.shiftKey && event.key.toLowerCase() === 'z';
      if (!isUndo || !points.length || event.target.closest('input:not([type="range"]):not([type="checkbox"])')) return;
      event.preventDefault();
      takeBack();
    });
    if (stage.works) listen();
    else { place.disabled = look.disabled = true; say('Points are placed in the 3-D scene, which needs WebGL.', 'bad'); }
    show();
  }
  begin();

  // What is drawn, for tests and scripts: SI units.
  const state = () => ({
    placing: isPlacing, busy: isBusy, object: field.object.value, kind: field.kind.value, name: field.name.value, points_m: points.map((p) => p.point_m), outward: points.map((p) => p.outward),
    line_m: along, report, table: table.hidden ? null : table.textContent, written, message: message.textContent,
  });
  return { state };
})();
