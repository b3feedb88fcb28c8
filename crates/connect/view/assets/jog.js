// Sliders of the joints and numbers of the tool centre points: what they ask for is decided by the program.
const Jog = (() => {
  const OWN_MS = 400; // after an input of a person, frames do not change it for this long
  const isOn = Data.mode === 'jog';
  byId('jog-card').hidden = !isOn;
  const message = byId('message');
  const robots = isOn ? Data.robots.map(build) : [];

  function build(robot, index) {
    const set = element('details', { open: index === 0 }, element('summary', { textContent: robot.name }));
    byId('jog').append(set);
    const own = { q: [...robot.start], touched: -Infinity, index, tcp: null };
    own.joints = robot.sliders.map((slider, k) => joint(set, own, slider, k));
    own.pose = pose(set, own, robot);
    return own;
  }

  // A slider and a number, in millimetres or degrees.
  function joint(set, own, slider, k) {
    const unit = slider.slides ? 1e-3 : Units.DEGREE, id = `joint-${own.index}-${k}`;
    const input = element('input', { type: 'range', id, step: 'any', min: slider.lower, max: slider.upper, value: own.q[k] });
    const number = element('input', { type: 'number', step: 'any', id: `${id}-number` });
    number.setAttribute('aria-label', `${slider.name}, ${slider.slides ? 'millimetres' : 'degrees'}`);
    const set_ = (value) => {
      own.q[k] = value;
      own.touched = performance.now();
      Link.send({ type: 'jog', robot: own.index, q: own.q });
    };
    input.addEventListener('input', () => set_(Number(input.value)));
    noteTyping(number);
    number.addEventListener('change', () => { if (number.value !== '') set_(Number(number.value) * unit); });
    set.append(element('div', { className: 'joint' }, element('label', { htmlFor: id, textContent: slider.name }), input, number));
    return { input, number, unit, slides: slider.slides, lower: slider.lower, upper: slider.upper };
  }

  // Position and angles of the tool centre point in the world.
  function pose(set, own, robot) {
    const holder = element('div', { className: 'tcp' });
    holder.setAttribute('role', 'group');
    holder.setAttribute('aria-label', `tool centre point of ${robot.name}`);
    set.append(holder);
    const inputs = ['x mm', 'y mm', 'z mm', 'roll °', 'pitch °', 'yaw °'].map((name, k) => {
      const input = element('input', { type: 'number', step: 'any', id: `tcp-${own.index}-${k}` });
      holder.append(element('label', { htmlFor: input.id }, name, input));
      noteTyping(input);
      input.addEventListener('change', () => {
        const values = inputs.map((i) => Number(i.value));
        moveTcp(own.index, values.slice(0, 3).map((x) => x / 1000), Units.quaternion(values.slice(3)));
      });
      return input;
    });
    return inputs;
  }

  // What a person types stands until it is sent: then the program says what became of it.
  const isTyped = (input) => input.dataset.typed === 'true';
  function noteTyping(input) {
    input.addEventListener('input', () => { input.dataset.typed = 'true'; });
    for (const done of ['change', 'blur']) input.addEventListener(done, () => { input.dataset.typed = 'false'; });
  }

  const moveTcp = (robot, position_m, quaternion_xyzw) => Link.send({ type: 'tcp', robot, position_m, quaternion_xyzw });

  function showOwn(own, robot, isRefused) {
    // A refused value does not stay.
    if (isRefused || performance.now() - own.touched > OWN_MS) own.q = [...robot.q];
    own.joints.forEach(({ input, number, unit, slides, lower, upper }, k) => {
      // A start may lie beyond the limits of the slider.
      input.min = Math.min(lower, own.q[k]);
      input.max = Math.max(upper, own.q[k]);
      const shown = Units.rounded(own.q[k] / unit, slides ? 1 : 2);
      if (Number(input.value) !== own.q[k]) input.value = own.q[k];
      input.setAttribute('aria-valuetext', slides ? `${shown} mm` : `${shown}°`);
      if (!isTyped(number)) number.value = shown;
    });
    if (!robot.tcp) return;
    own.tcp = robot.tcp;
    const values = [...robot.tcp.position_m.map((x) => 1000 * x), ...Units.angles(robot.tcp.quaternion_xyzw)];
    own.pose.forEach((input, k) => { if (!isTyped(input)) input.value = Units.rounded(values[k], 2); });
  }

  function show(frame) {
    if (message.textContent !== frame.message) message.textContent = frame.message;
    robots.forEach((own, i) => showOwn(own, frame.robots[i], frame.message !== ''));
  }

  const home = () => { robots.forEach((own) => { own.touched = -Infinity; }); Link.send({ type: 'home' }); };
  byId('home').addEventListener('click', home);

  return { isOn, show, home, moveTcp, tcp: (robot) => robots[robot]?.tcp };
})();
