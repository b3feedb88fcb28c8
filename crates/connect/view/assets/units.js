// Numbers as they are shown: millimetres and degrees.
const Units = (() => {
  const DEGREE = Math.PI / 180;
  // Plus 0, which makes −0 a 0.
  const rounded = (value, digits) => (Number(value.toFixed(digits)) + 0).toFixed(digits);
  const millimetres = (metres) => (metres === 0 ? 'contact' : `${rounded(1000 * metres, metres < 0.1 ? 2 : 1)} mm`);
  const toRegion = (metres) => (metres === 0 ? 'inside' : millimetres(metres));
  const seconds = (s) => `${rounded(s, 2)} s`;

  // Roll, pitch and yaw (degrees) of a quaternion x y z w, and back: Rz(yaw) · Ry(pitch) · Rx(roll).
  function angles([x, y, z, w]) {
    const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
    const pitch = Math.asin(Math.min(1, Math.max(-1, 2 * (w * y - z * x))));
    const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
    return [roll, pitch, yaw].map((a) => a / DEGREE);
  }
  function quaternion(degrees) {
    const [r, p, y] = degrees.map((a) => (a * DEGREE) / 2);
    const [cr, sr, cp, sp, cy, sy] = [Math.cos(r), Math.sin(r), Math.cos(p), Math.sin(p), Math.cos(y), Math.sin(y)];
    return [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy];
  }

  return { DEGREE, rounded, millimetres, toRegion, seconds, angles, quaternion };
})();
