// What is shown when: the newest frame, or one of the last minutes.
(() => {
  const [play, scrub, clock, speed, now] = ['play', 'scrub', 'clock', 'speed', 'now'].map(byId);
  const STALE_MS = 1500;
  let shown = null, isLive = true, isPlaying = true, t = 0, newest = null, heard = 0, last = 0, rate = 0;
  document.title = `${Data.cell} – elbowroom`;
  byId('title').textContent = Data.cell || 'Cell';

  function show(frame) {
    shown = Instant.of(frame);
    Scene.show(shown);
    Drag.place?.(shown);
    Tables.show(shown);
    Jog.show(frame);
    t = frame.t_s;
  }

  function showTime() {
    const [first, end] = [History.first(), History.last()];
    scrub.min = first;
    scrub.max = Math.max(end, first + 1e-3);
    scrub.value = isLive ? scrub.max : t;
    clock.textContent = Units.seconds(t);
    scrub.setAttribute('aria-valuetext', isLive ? `now, ${clock.textContent}` : clock.textContent);
    now.setAttribute('aria-pressed', String(isLive));
    play.textContent = isPlaying ? 'pause' : 'play';
    play.setAttribute('aria-label', isPlaying ? 'pause' : 'play');
    play.setAttribute('aria-pressed', String(!isPlaying));
    document.body.classList.toggle('replay', !isLive);
  }

  function live() {
    isLive = true;
    isPlaying = true;
    if (newest) show(newest);
    showTime();
  }

  // Leaves the present.
  function seek(to) {
    if (!newest) return;
    isLive = false;
    t = Math.min(History.last(), Math.max(History.first(), to));
    const at = t;
    show(History.at(t));
    t = at;
    showTime();
  }

  function step(time) {
    if (isLive || !isPlaying) return;
    const to = t + (Number(speed.value) * (time - last)) / 1000;
    last = time;
    if (to >= History.last()) { live(); return; }
    seek(to);
    requestAnimationFrame(step);
  }

  function setPlaying(on) {
    isPlaying = on;
    if (!on) seek(t);
    else if (!isLive) { last = performance.now(); requestAnimationFrame(step); }
    showTime();
  }

  // Frames that come between two pictures are not drawn; the program gets the number of what has been shown.
  let waiting = null, isEarlierKnown = false;
  async function fetchEarlier() {
    const response = await fetch('/history', { headers: { Authorization: `Bearer ${Link.token}` } }).catch(() => null);
    if (response && response.ok) { History.addEarlier(await response.json()); showTime(); }
  }
  Link.onFrame((frame) => {
    heard = performance.now();
    newest = frame;
    History.add(frame);
    if (!isEarlierKnown) { isEarlierKnown = true; fetchEarlier(); }
    if (Link.state() === 'stale') Link.setState('open');
    if (waiting) { waiting = frame; return; }
    waiting = frame;
    const draw = () => {
      if (isLive) show(waiting);
      showTime();
      Link.send({ shown: waiting.number });
      waiting = null;
      document.documentElement.dataset.ready = 'true';
    };
    // A page in the background draws nothing.
    if (document.hidden) draw(); else requestAnimationFrame(() => { draw(); Scene.stage.flush(); });
  });
  Link.onEvents(Tables.addEvents);

  play.addEventListener('click', () => setPlaying(!isPlaying));
  scrub.addEventListener('input', () => { isPlaying = false; seek(Number(scrub.value)); });
  now.addEventListener('click', live);
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const control = event.target.closest('select, input, button'), key = event.key.toLowerCase();
    if (control && control.matches('input[type="number"], input[type="text"], select')) return;
    const jump = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const press = { f: 'fit', 1: 'look-top', 2: 'look-front', 3: 'look-side', '+': 'closer', '-': 'farther', d: 'theme', l: 'now', ...(Jog.isOn ? { h: 'home' } : {}) }[key];
    if (press) byId(press).click();
    else if (control) return;
    else if (event.key === ' ') { event.preventDefault(); setPlaying(!isPlaying); }
    else if (jump) { event.preventDefault(); isPlaying = false; seek(t + jump * (event.shiftKey ? 1 : 0.1)); }
  });

  // News of a running cell that stay out; pictures per second.
  let counted = Scene.stage.rendered(), since = performance.now();
  setInterval(() => {
    const time = performance.now(), pictures = Scene.stage.rendered();
    rate = (1000 * (pictures - counted)) / (time - since);
    [counted, since] = [pictures, time];
    if (Data.mode === 'watch' && Link.state() === 'open' && heard && !waiting && time - heard > STALE_MS) Link.setState('stale');
  }, 1000);

  // What the page shows, for tests and scripts: SI units.
  window.elbowroom = {
    state: () => {
      if (!shown) return { connection: Link.state(), mode: Data.mode, cell: Data.cell, t_s: null, robots: [], regions: [], objects: [], slots: [], events: [] };
      const { frame } = shown, regions = [...shown.regions, ...shown.added];
      return {
        connection: Link.state(), mode: Data.mode, cell: Data.cell, checksum: Data.checksum, t_s: isLive ? frame.t_s : t, frame_t_s: frame.t_s, live: isLive, number: frame.number,
        message: frame.message, nearest: pair(frame.nearest),
        robots: frame.robots.map((robot, i) => ({
          name: robot.robot, known: shown.robots[i].isKnown, q: robot.q, tcp: robot.tcp, tcp_drawn_m: shown.robots[i].tcp, override: robot.override,
          reason: robot.reason, region: robot.region, exchange: robot.exchange, nearest: pair(robot.nearest), nearest_self: pair(robot.nearest_self),
          regions: robot.distances.map((d) => ({ region: d.region, part: d.part, distance_m: d.distance_m, points: d.points_m })),
        })),
        regions: regions.map(({ pose, ...region }) => ({ ...region, position_m: pose.slice(9) })),
        objects: shown.objects.map(({ name, pose }) => ({ name, position_m: pose.slice(9) })),
        slots: frame.slots, events: Tables.events(), drawing: Draw.state(),
        frames_kept: History.count(), pictures: Scene.stage.rendered(), pictures_per_s: rate, clock_s: performance.now() / 1000, pixel_ratio: Scene.stage.works ? Scene.stage.pixelRatio() : null, triangles: Scene.stage.works ? Scene.stage.triangles() : null, measured_in_s: frame.measured_in_s,
      };
    },
    handles: Drag.handles,
    // Where a point of the world is in the canvas.
    pixels: (point) => Scene.pixels(new THREE.Vector3(...point)),
  };
  const pair = (p) => p && { a: p.a, b: p.b, distance_m: p.distance_m, points: p.points_m };
  Link.connect();
})();
