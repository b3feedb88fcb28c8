// Playback time, shared by the scene, the cursors of the plots and the readout.
(() => {
  const { data } = Stage;
  const byId = (id) => document.getElementById(id);
  const [play, scrub, clock, speed, runSelect, readout] = ['play', 'scrub', 'clock', 'speed', 'run', 'readout'].map(byId);
  let run = 0, t = 0, playing = false, last = 0;

  byId('run-label').hidden = data.runs.length < 2;
  const rows = [];

  function buildReadout() {
    readout.replaceChildren();
    rows.length = 0;
    for (const robot of data.runs[run].robots) {
      const row = document.createElement('div');
      row.className = 'robot';
      const [name, percent, why] = ['b', 'span', 'span'].map((tag) => document.createElement(tag));
      const bar = document.createElement('div'), fill = document.createElement('i');
      bar.className = 'bar';
      bar.append(fill);
      name.textContent = robot.name;
      row.append(name, bar, percent, why);
      readout.append(row);
      rows.push({ fill, percent, why });
    }
  }

  // The frame at or before t, and the interpolation parameter to the next one.
  function frameAt(times) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t + 1e-6) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, times.length - 1);
    const span = times[next] - times[low];
    return { frame: low, next, part: span > 0 ? Math.min(1, Math.max(0, (t - times[low]) / span)) : 0 };
  }

  function update() {
    const track = data.runs[run];
    if (!track || !track.t.length) return;
    const at = frameAt(track.t);
    Stage.show(run, t, at);
    Figures.setTime(t);
    scrub.value = t;
    clock.textContent = `${t.toFixed(3)} s`;
    track.robots.forEach((robot, i) => {
      const v = robot.override[at.frame], d = robot.distance[at.frame];
      rows[i].fill.style.width = `${100 * v}%`;
      rows[i].fill.style.background = `hsl(${120 * v} 75% 42%)`;
      rows[i].percent.textContent = `${(100 * v).toFixed(1)} %`;
      const gap = Number.isFinite(d) ? `, ${(1000 * d).toFixed(1)} mm away` : '';
      const atEnd = at.frame === track.t.length - 1 ? ` · ${robot.outcome}` : '';
      rows[i].why.textContent = `${robot.reasons[robot.reason[at.frame]]}${gap} · ${robot.speed[at.frame].toFixed(3)} m/s${atEnd}`;
    });
  }

  const end = () => { const times = data.runs[run].t; return times.length ? times[times.length - 1] : 0; };
  function seek(to) { t = Math.min(end(), Math.max(0, to)); update(); }
  function setPlaying(on) {
    playing = on;
    play.textContent = on ? '⏸' : '▶';
    if (!on) return;
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
    seek(t);
  }

  play.addEventListener('click', () => setPlaying(!playing));
  scrub.addEventListener('input', () => { setPlaying(false); seek(Number(scrub.value)); });
  runSelect.addEventListener('change', () => selectRun(Number(runSelect.value)));
  Figures.onTime((to) => { if (!playing) seek(to); });
  document.addEventListener('keydown', (event) => {
    if (event.target.closest && event.target.closest('select, input')) return;
    const jump = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === ' ') { event.preventDefault(); setPlaying(!playing); }
    else if (jump) { event.preventDefault(); setPlaying(false); seek(t + jump * (event.shiftKey ? 0.5 : 0.05)); }
    else if (event.key === 'Home') seek(0);
    else if (event.key === 'End') seek(end());
  });

  if (data.runs.length) {
    // #t=1.5&run=1 opens the page at this time and run.
    const wanted = new URLSearchParams(location.hash.slice(1));
    t = Number(wanted.get('t')) || 0;
    const first = Math.min(data.runs.length - 1, Math.max(0, Number(wanted.get('run')) || 0));
    runSelect.value = String(first);
    selectRun(first);
  }
  window.addEventListener('resize', () => setTimeout(() => Figures.setTime(t), 150));
})();
