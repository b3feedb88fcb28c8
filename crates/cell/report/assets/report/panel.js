// Sliders of the joints, and the distances of the robots to every region and object.
function millimetres(metres) {
  if (metres === 0) return 'contact';
  return `${(1000 * metres).toFixed(3)} mm`;
}

const Panel = (() => {
  const joints = byId('joints'), distances = byId('distances');
  let onMove = () => {};
  // Joint values in the mode "move the joints"; null in the recording.
  let moved = null;

  // Plus 0, which makes −0 a 0.
  const rounded = (value, digits) => (Number(value.toFixed(digits)) + 0).toFixed(digits);
  const shownJoint = (slider, value) => (slider.slides ? `${rounded(1000 * value, 1)} mm` : `${rounded((180 * value) / Math.PI, 2)}°`);
  const inputs = Data.robots.map((robot, i) => {
    const set = element('fieldset', {}, element('legend', { textContent: robot.name }));
    joints.append(set);
    return robot.sliders.map((slider, k) => {
      const id = `joint-${i}-${k}`;
      const input = element('input', { type: 'range', id, step: 'any', min: slider.lower, max: slider.upper, value: 0 });
      const output = element('output');
      output.htmlFor = id;
      input.addEventListener('input', () => {
        moved[i][k] = Number(input.value);
        showJoint(i, k);
        onMove();
      });
      set.append(element('label', { htmlFor: id, textContent: slider.name }), input, output);
      return { input, output };
    });
  });

  function showJoint(i, k) {
    const { input, output } = inputs[i][k], slider = Data.robots[i].sliders[k];
    output.textContent = shownJoint(slider, moved[i][k]);
    input.setAttribute('aria-valuetext', output.textContent);
  }

  // Starts from these joint values, or returns to the recording with null.
  function move(q) {
    moved = q && q.map((values) => [...values]);
    joints.hidden = !moved;
    if (!moved) return;
    Data.robots.forEach((robot, i) => robot.sliders.forEach((slider, k) => {
      const { input } = inputs[i][k];
      // A recorded value may lie beyond the limits of the slider.
      input.min = Math.min(slider.lower, moved[i][k]);
      input.max = Math.max(slider.upper, moved[i][k]);
      input.value = moved[i][k];
      showJoint(i, k);
    }));
  }

  const rows = new Map();
  const many = Data.robots.length > 1;
  const body = element('tbody');
  const head = [...(many ? ['robot'] : []), 'region or object', 'distance now', 'closest part'];
  if (Cell.targets.length && Data.robots.some((robot) => robot.volumes.length)) {
    distances.append(element('div', { className: 'scroll', tabIndex: 0 }, element('table', {},
      element('caption', { textContent: 'Distances at the shown instant, from the volumes that the monitor guards: they enclose the links' }),
      element('thead', {}, element('tr', {}, ...head.map((text) => element('th', { scope: 'col', textContent: text })))), body)));
  }

  function rowOf({ robot, target }) {
    const key = `${robot} ${target.kind} ${target.index}`;
    if (!rows.has(key)) {
      const chip = element('i', { className: 'chip' });
      chip.style.background = target.color;
      const cells = [element('td', {}, chip, target.name, ...(target.kind === 'object' ? [element('span', { className: 'faint', textContent: ' (object)' })] : [])), element('td', { className: 'number' }), element('td')];
      if (many) cells.unshift(element('td', { textContent: Data.robots[robot].name }));
      const row = element('tr', {}, ...cells);
      Object.assign(row.dataset, { robot: Data.robots[robot].name, kind: target.kind, name: target.name });
      body.append(row);
      rows.set(key, { row, distance: cells.at(-2), part: cells.at(-1) });
    }
    return rows.get(key);
  }

  function show(pairs) {
    for (const pair of pairs) {
      const { row, distance, part } = rowOf(pair);
      const known = pair.distance !== undefined;
      distance.textContent = [known ? millimetres(pair.distance) : '', pair.state].filter(Boolean).join(', ');
      part.textContent = known ? pair.part : '–';
      row.className = pair.state ? 'off' : '';
      if (known) row.dataset.metres = pair.distance; else delete row.dataset.metres;
    }
  }

  return { show, move, moved: () => moved, onMove: (f) => { onMove = f; } };
})();
