// Robots, distances, regions, interlocks and events as text.
const Tables = (() => {
  const MAX_EVENTS = 200;
  // What is older than this may be wrong by now, s.
  const SILENT_S = 0.5;
  // Faults of a robot that follow each other faster than this are one line, s.
  const REPEATED_S = 2;
  const text = (node, value) => { if (node.textContent !== value) node.textContent = value; };
  const pairText = (pair) => (pair ? `${pair.a} – ${pair.b}` : '–');
  const distanceClass = (metres) => (metres === 0 ? 'number state-contact' : 'number');

  function table(holder, caption, heads) {
    const body = element('tbody');
    holder.append(element('table', {}, element('thead', {}, element('tr', {}, ...heads.map((h) => element('th', { scope: 'col', textContent: h })))), body));
    body.parentElement.setAttribute('aria-label', caption);
    return body;
  }
  // As many rows as needed, of as many cells.
  function rows(body, count, cells) {
    while (body.rows.length > count) body.deleteRow(-1);
    while (body.rows.length < count) body.append(element('tr', {}, ...Array.from({ length: cells }, () => element('td'))));
    return [...body.rows];
  }

  const cards = Data.robots.map((robot) => {
    const [percent, reason, numbers] = [element('span', { className: 'percent' }), element('p'), element('p', { className: 'numbers' })];
    const fill = element('i'), bar = element('div', { className: 'bar' }, fill);
    bar.setAttribute('role', 'meter');
    bar.setAttribute('aria-label', `override of ${robot.name}`);
    bar.setAttribute('aria-valuemin', '0');
    bar.setAttribute('aria-valuemax', '100');
    const chip = element('i', { className: 'chip' });
    if (robot.solids.length) chip.style.background = robot.solids[0].color;
    byId('robots').append(element('div', { className: 'robot' }, element('div', { className: 'head' }, element('b', {}, chip, robot.name), bar, percent), reason, numbers));
    return { card: byId('robots').lastElementChild, percent, reason, numbers, fill, bar };
  });

  function showRobot(robot, i, drawn) {
    const { card, percent, reason, numbers, fill, bar } = cards[i], v = robot.override;
    card.classList.toggle('silent', robot.health.age_s > SILENT_S);
    fill.style.width = `${100 * v}%`;
    fill.style.background = `hsl(${120 * v} 75% 42%)`;
    bar.setAttribute('aria-valuenow', (100 * v).toFixed(1));
    text(percent, `${(100 * v).toFixed(1)} %`);
    const exchange = Object.entries(robot.exchange).filter(([, state]) => state !== 'outside').map(([name, state]) => `${name}: ${state}`);
    text(reason, [robot.reason, ...exchange].join(' · '));
    const tcp = robot.tcp ? robot.tcp.position_m : drawn.tcp;
    text(numbers, drawn.isKnown ? `TCP ${tcp.map((x) => Units.rounded(1000 * x, 1)).join(', ')} mm` : 'joint values unknown');
  }

  const distances = table(byId('distances'), 'distances', ['robot', 'nearest', 'distance']);
  function showDistances({ robots, nearest }) {
    const list = robots.flatMap((robot) => [
      ...(robot.nearest ? [{ robot: robot.robot, what: pairText(robot.nearest), metres: robot.nearest.distance_m, kind: 'pair' }] : []),
      ...(robot.nearest_self ? [{ robot: robot.robot, what: `itself: ${pairText(robot.nearest_self)}`, metres: robot.nearest_self.distance_m, kind: 'self' }] : []),
      ...robot.distances.map((d) => ({ robot: robot.robot, what: `${d.part} – ${d.region}`, metres: d.distance_m, kind: 'region' })),
    ]);
    if (nearest) list.push({ robot: 'all', what: pairText(nearest), metres: nearest.distance_m, kind: 'all' });
    rows(distances, list.length, 3).forEach((row, i) => {
      const { robot, what, metres, kind } = list[i];
      const [a, b, c] = row.cells;
      text(a, robot);
      text(b, what);
      text(c, kind === 'region' ? Units.toRegion(metres) : Units.millimetres(metres));
      c.className = distanceClass(metres);
      Object.assign(row.dataset, { robot, kind, metres });
    });
  }

  const regions = table(byId('regions'), 'regions', ['region', 'kind', 'state']);
  const stateText = (r) => {
    const who = (list) => list.join(', ');
    if (r.state === 'off') return 'off';
    if (r.state === 'inside') return `inside: ${who(r.inside)}`;
    if (r.state === 'warned') return `warning: ${who(r.warned)}`;
    if (r.state === 'closed') return `closed to ${who(r.closed_to)}`;
    return 'clear';
  };
  function showRegions(list) {
    byId('regions-card').hidden = !list.length;
    rows(regions, list.length, 3).forEach((row, i) => {
      const [name, kind, state] = row.cells, r = list[i];
      if (name.textContent !== r.name) {
        const chip = element('i', { className: 'chip' });
        chip.style.background = Data.regions[i]?.color ?? 'gray';
        name.replaceChildren(chip, r.name);
      }
      text(kind, r.kind);
      text(state, stateText(r));
      state.className = `state-${r.state}`;
    });
  }

  const slots = table(byId('slots'), 'interlocks', ['regions', 'holder', 'waiting']);
  function showSlots(list) {
    byId('slots-card').hidden = !list.length;
    const age = Math.max(0, ...list.map((slot) => slot.age_s)), silent = age > SILENT_S;
    byId('arbiter-silent').hidden = !silent;
    if (silent) text(byId('arbiter-silent'), `The arbiter was heard ${age.toFixed(1)} s ago: no region is granted until it is back.`);
    byId('slots').classList.toggle('silent', silent);
    rows(slots, list.length, 3).forEach((row, i) => {
      const { regions: names, holder, queue } = list[i];
      [names.join(', '), holder || 'nobody', queue.join(', ') || 'nobody'].forEach((value, k) => text(row.cells[k], value));
    });
  }

  let events = [];
  const words = (event) => [event.robot, event.event.replaceAll('_', ' '), event.region].filter(Boolean).join(' · ');
  const line = (event) => element('li', {}, element('time', { textContent: Units.seconds(event.t_s) }), words(event));
  // Per robot its last series of faults: the line that shows it, how many, and when the first and the last one were.
  const faults = new Map();

  // Whether an event belongs to the series of faults that is shown already. A robot whose news comes and goes is lost and
  // recovered many times a second: that is one line, not thousands.
  function repeats(event) {
    const series = faults.get(event.robot);
    const goesOn = series && event.t_s >= series.last && event.t_s - series.last < REPEATED_S && series.item.isConnected;
    if (event.event === 'recovered') {
      if (goesOn) series.item.lastChild.textContent += ' · recovered';
      return goesOn;
    }
    if (event.event !== 'fault') return false;
    if (!goesOn) {
      const item = line(event);
      list.prepend(item);
      faults.set(event.robot, { item, count: 1, first: event.t_s, last: event.t_s });
      return true;
    }
    series.count += 1;
    series.last = event.t_s;
    series.item.firstChild.textContent = Units.seconds(event.t_s);
    series.item.lastChild.textContent = `${words(event)} ${series.count} times in ${(series.last - series.first).toFixed(1)} s`;
    list.prepend(series.item);
    return true;
  }

  const list = element('ol');
  byId('events').append(list);
  function addEvents(added) {
    const newest = events.length ? events[0].number : -1;
    // Numbers that begin again: the program is another one.
    if (added.length && added[added.length - 1].number < newest) { events = []; list.replaceChildren(); }
    for (const event of added.filter((e) => !events.length || e.number > events[0].number)) {
      events.unshift(event);
      if (!repeats(event)) list.prepend(line(event));
    }
    events.length = Math.min(events.length, MAX_EVENTS);
    while (list.children.length > MAX_EVENTS) list.lastChild.remove();
  }

  function write(instant) {
    instant.frame.robots.forEach((robot, i) => showRobot(robot, i, instant.robots[i]));
    showDistances(instant.frame);
    showRegions([...instant.regions, ...instant.added]);
    showSlots(instant.frame.slots);
  }

  // Numbers that change with every picture cannot be read, and new text costs the browser as much as the poses of the robots.
  const PERIOD_MS = 100;
  let newest = null, written = -Infinity, waiting = 0;
  function writeNewest() {
    waiting = 0;
    written = performance.now();
    write(newest);
  }
  function show(instant) {
    newest = instant;
    const wait = written + PERIOD_MS - performance.now();
    if (wait <= 0) { clearTimeout(waiting); writeNewest(); } else waiting ||= setTimeout(writeNewest, wait);
  }

  return { show, addEvents, events: () => events };
})();
