// Playback time and the joints moved by hand, shared by the scene, the distances, the cursors of the plots and the readout.
(() => {
  const [play, scrub, clock, speed, runSelect, readout, moveButton] = ['play', 'scrub', 'clock', 'speed', 'run', 'readout', 'move'].map(byId);
  // While playing, all distances are measured at most this often, ms.
  const MEASURE_EVERY = 100;
  let run = 0, t = 0, playing = false, last = 0, measured = 0, pairs = [], nearest = [];

  byId('run-label').hidden = Data.runs.length < 2;
  const rows = [];

  function buildReadout() {
    readout.replaceChildren();
    rows.length = 0;
    for (const robot of Data.runs[run].robots) {
      const [name, percent, why] = [element('b', { textContent: robot.name }), element('span'), element('span')];
      const fill = element('i');
      readout.append(element('div', { className: 'robot' }, name, element('div', { className: 'bar' }, fill), percent, why));
      rows.push({ fill, percent, why });
    }
  }

  function showReadout(cell) {
    const { frame } = cell.frame;
    cell.run.robots.forEach((robot, i) => {
      const v = robot.override[frame], d = robot.distance[frame];
      rows[i].fill.style.width = `${100 * v}%`;
      rows[i].fill.style.background = `hsl(${120 * v} 75% 42%)`;
      rows[i].percent.textContent = `${(100 * v).toFixed(1)} %`;
      const gap = Number.isFinite(d) ? `, ${(1000 * d).toFixed(1)} mm away` : '';
      const atEnd = frame === cell.run.t.length - 1 ? ` · ${robot.outcome}` : '';
      rows[i].why.textContent = `${robot.reasons[robot.reason[frame]]}${gap} · ${robot.speed[frame].toFixed(3)} m/s${atEnd}`;
    });
  }

  const isMeasured = (pair) => pair.distance !== undefined && !pair.state;

  // What the line of a robot leads to: the region that governs, or the object that it evades, else what was nearest.
  function targetOf(cell, robot) {
    const track = cell.run.robots[robot], { frame } = cell.frame;
    const of = (kind, index) => Cell.targets.find((target) => target.kind === kind && target.index === index);
    return (!cell.moved && (of('region', track.region[frame]) || of('object', track.obstacle[frame]))) || nearest[robot];
  }

  function measure(cell) {
    pairs = Cell.pairs(cell);
    nearest = Data.robots.map((_, robot) => {
      const own = pairs.filter((pair) => pair.robot === robot && isMeasured(pair));
      return own.reduce((best, pair) => (!best || pair.distance < best.distance ? pair : best), null)?.target;
    });
    Panel.show(pairs);
  }

  function lineOf(cell, robot) {
    const target = targetOf(cell, robot);
    const pair = target && Cell.pair(cell, robot, target);
    return pair && isMeasured(pair) ? pair : null;
  }

  function update() {
    const track = Data.runs[run];
    if (!track || !track.t.length) return;
    const cell = Cell.at(run, t, Panel.moved());
    const now = performance.now();
    if (!playing || now - measured > MEASURE_EVERY) {
      measured = now;
      measure(cell);
    }
    Stage.show(run, cell, Data.robots.map((_, i) => lineOf(cell, i)));
    Figures.setTime(t);
    scrub.value = t;
    clock.textContent = `${t.toFixed(3)} s`;
    scrub.setAttribute('aria-valuetext', clock.textContent);
    showReadout(cell);
    Perceived.list(byId('perceived'), track, t);
  }

  const end = () => { const times = Data.runs[run].t; return times.length ? times[times.length - 1] : 0; };
  function seek(to) { t = Math.min(end(), Math.max(0, to)); update(); }
  function setPlaying(on) {
    playing = on;
    play.textContent = on ? '⏸' : '▶';
    play.setAttribute('aria-pressed', String(on));
    play.setAttribute('aria-label', on ? 'pause' : 'play');
    if (!on) { update(); return; }
    moveJoints(false);
    if (t >= end()) t = 0;
    last = performance.now();
    requestAnimationFrame(step);
  }
  function step(now) {
    if (!playing) return;
    const to = t + Number(speed.value) * (now - last) / 1000;
    last = now;
    seek(to);
    if (t >= end()) setPlaying(false); else requestAnimationFrame(step);
  }
  function selectRun(index) {
    run = index;
    scrub.max = end();
    buildReadout();
    Figures.showRun(run);
    moveJoints(false);
    seek(t);
  }
  // In this mode the robots stand where the sliders say; regions and objects stay where they are at the shown time.
  function moveJoints(on) {
    if (on === Boolean(Panel.moved())) return;
    if (on && playing) setPlaying(false);
    Panel.move(on ? Cell.at(run, t).q : null);
    moveButton.setAttribute('aria-pressed', String(on));
    moveButton.textContent = on ? 'back to the recording' : 'move the joints';
    document.body.classList.toggle('moving', on);
    update();
  }

  play.addEventListener('click', () => setPlaying(!playing));
  scrub.addEventListener('input', () => { if (playing) setPlaying(false); moveJoints(false); seek(Number(scrub.value)); });
  runSelect.addEventListener('change', () => selectRun(Number(runSelect.value)));
  moveButton.addEventListener('click', () => moveJoints(!Panel.moved()));
  byId('fit').addEventListener('click', Stage.fit);
  Panel.onMove(update);
  Figures.onTime((to) => { if (!playing && !Panel.moved()) seek(to); });
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const at = event.target.closest ? event.target.closest('select, input, button') : null;
    const jump = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const key = event.key.toLowerCase();
    if (key === 'm') moveJoints(!Panel.moved());
    else if (key === 'f') Stage.fit();
    else if (at) return;
    else if (event.key === ' ') { event.preventDefault(); setPlaying(!playing); }
    else if (jump) { event.preventDefault(); setPlaying(false); seek(t + jump * (event.shiftKey ? 0.5 : 0.05)); }
    else if (event.key === 'Home') seek(0);
    else if (event.key === 'End') seek(end());
  });

  if (Data.runs.length) {
    // #t=1.5&run=1 opens the page at this time and run; without a time at the first stop or collision.
    const wanted = new URLSearchParams(location.hash.slice(1));
    const first = Math.min(Data.runs.length - 1, Math.max(0, Number(wanted.get('run')) || 0));
    t = wanted.has('t') ? Number(wanted.get('t')) || 0 : Data.runs[first].opens_s;
    runSelect.value = String(first);
    selectRun(first);
    if (wanted.has('move')) moveJoints(true);
  }
  window.addEventListener('resize', () => setTimeout(() => Figures.setTime(t), 150));

  // What the page shows, for tests and scripts: SI units.
  window.elbowroom = {
    state: () => ({
      t_s: t, run, playing, moved: Boolean(Panel.moved()), q: Data.runs.length ? Cell.at(run, t, Panel.moved()).q : [],
      distances: pairs.map((pair) => ({
        robot: Data.robots[pair.robot].name, kind: pair.target.kind, name: pair.target.name, state: pair.state,
        distance_m: pair.distance ?? null, part: pair.part ?? null, on_robot_m: pair.onA ?? null, on_other_m: pair.onB ?? null,
      })),
      perceived: Data.runs.length ? Perceived.known(Data.runs[run], t) : [], drawn: Stage.perceived(),
    }),
    seek: (time) => { moveJoints(false); seek(time); },
  };
  document.documentElement.dataset.ready = 'true';
})();
