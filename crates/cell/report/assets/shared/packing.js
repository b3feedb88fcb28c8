// Arrays of quantised numbers, as `packing.rs` writes them.
const Packing = (() => {
  // Differences to the row before, all low bytes first; 0 stands for NaN.
  function read(arrays, { at, n, width, step, zero }) {
    const levels = new Uint32Array(n), values = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      const coded = (arrays[at + i] | (arrays[at + n + i] << 8) | (arrays[at + 2 * n + i] << 16) | (arrays[at + 3 * n + i] << 24)) >>> 0;
      const difference = (coded >>> 1) ^ -(coded & 1);
      levels[i] = difference + (i >= width ? levels[i - width] : 0);
      values[i] = levels[i] === 0 ? NaN : zero + step * levels[i];
    }
    return values;
  }

  return { read };
})();
