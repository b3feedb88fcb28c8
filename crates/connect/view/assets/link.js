// The connection to the program: the token first, then frames and events from it and commands to it.
const Link = (() => {
  const token = new URLSearchParams(location.hash.slice(1)).get('token') || '';
  const label = byId('connection'), trouble = byId('trouble');
  const NAMES = { connecting: 'connecting', open: 'connected', stale: 'no news', closed: 'connection lost', refused: 'refused' };
  const RETRY_MS = 1000, LONGEST_RETRY_MS = 8000;
  let state = 'connecting', socket = null, retry = RETRY_MS, onFrame = () => {}, onEvents = () => {};

  function setState(next, why) {
    if (state !== next) label.textContent = NAMES[next];
    state = next;
    label.dataset.state = next;
    if (why !== undefined) { trouble.textContent = why; trouble.hidden = !why; }
  }

  function connect() {
    const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/socket`;
    socket = new WebSocket(url);
    let isRefused = false;
    socket.addEventListener('open', () => socket.send(JSON.stringify({ token })));
    socket.addEventListener('message', ({ data }) => {
      const message = JSON.parse(data);
      if (message.type === 'hello') { retry = RETRY_MS; setState('open', ''); } else if (message.type === 'events') onEvents(message.events);
      else onFrame(message);
    });
    socket.addEventListener('close', ({ code, reason }) => {
      // 4400 to 4499: the program does not want this page.
      isRefused = code >= 4400 && code < 4500;
      setState(isRefused ? 'refused' : 'closed', isRefused ? `The program refuses this page: ${reason}. Open the address that it has printed.` : 'The connection to the program is lost: what is shown is old.');
      if (isRefused) return;
      setTimeout(connect, retry);
      retry = Math.min(LONGEST_RETRY_MS, 2 * retry);
    });
  }

  const send = (message) => { if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message)); };

  return {
    token, connect, send, setState,
    state: () => state,
    onFrame: (f) => { onFrame = f; },
    onEvents: (f) => { onEvents = f; },
  };
})();
