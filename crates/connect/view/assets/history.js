// The frames of the last minutes, for the time line. Frames that come faster than it keeps replace the newest one.
const History = (() => {
  const KEPT_S = 300, SPACING_S = 0.1;
  let frames = [];

  function add(frame) {
    const newest = frames[frames.length - 1], before = frames[frames.length - 2];
    // A service that has started again counts its time from 0.
    if (newest && frame.t_s < newest.t_s) frames = [];
    if (newest && before && newest.t_s - before.t_s < SPACING_S && frames.length > 1) frames.pop();
    frames.push(frame);
    let old = 0;
    while (frames[old].t_s < frame.t_s - KEPT_S) old += 1;
    if (old) frames.splice(0, old);
  }

  // Frames of the time before this page was opened.
  function addEarlier(earlier) {
    const first = frames.length ? frames[0].t_s : Infinity;
    frames = earlier.filter((frame) => frame.t_s < first).concat(frames);
  }

  // The last frame at or before a time, else the first one.
  function at(t) {
    let low = 0, high = frames.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (frames[middle].t_s <= t + 1e-9) low = middle; else high = middle - 1;
    }
    return frames[low];
  }

  return { add, addEarlier, at, first: () => (frames.length ? frames[0].t_s : 0), last: () => (frames.length ? frames[frames.length - 1].t_s : 0), count: () => frames.length };
})();
