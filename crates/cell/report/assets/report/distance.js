// Distances between solids, in metres and f64. Every solid is a set of convex pieces with a radius around each: a sphere is
// a point with a radius, a capsule a segment, a mesh its triangles. Between two pieces the algorithm of Gilbert, Johnson and
// Keerthi measures until its own lower bound agrees to 1e-11 m; a tree of boxes finds the pieces that matter.
const Distance = (() => {
  const AGREED = 1e-11, CONTACT = 1e-10, MAX_STEPS = 200, LEAF = 6;
  const { relative, apply } = Kinematics;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const rotate = (p, [x, y, z]) => [p[0] * x + p[1] * y + p[2] * z, p[3] * x + p[4] * y + p[5] * z, p[6] * x + p[7] * y + p[8] * z];
  const unrotate = (p, [x, y, z]) => [p[0] * x + p[3] * y + p[6] * z, p[1] * x + p[4] * y + p[7] * z, p[2] * x + p[5] * y + p[8] * z];

  // The farthest of some vertices along a direction.
  function farthest(v, from, to, d) {
    let best = from, most = -Infinity;
    for (let i = from; i < to; i += 3) {
      const along = v[i] * d[0] + v[i + 1] * d[1] + v[i + 2] * d[2];
      if (along > most) { most = along; best = i; }
    }
    return [v[best], v[best + 1], v[best + 2]];
  }

  const SUPPORTS = {
    sphere: () => () => [0, 0, 0],
    capsule: ({ half }) => (d) => [0, 0, d[2] < 0 ? -half : half],
    cylinder: ({ half, radius }) => (d) => {
      const across = Math.hypot(d[0], d[1]), k = across > 0 ? radius / across : 0;
      return [d[0] * k, d[1] * k, d[2] < 0 ? -half : half];
    },
    box: ({ half }) => (d) => [d[0] < 0 ? -half[0] : half[0], d[1] < 0 ? -half[1] : half[1], d[2] < 0 ? -half[2] : half[2]],
    hull: ({ mesh }) => (d) => farthest(Data.meshes[mesh].v, 0, Data.meshes[mesh].v.length, d),
  };

  // A shape of the data, ready to be measured; null where the data has none.
  function solid(shape) {
    if (!shape) return null;
    if (shape.kind === 'plane') return { plane: true };
    if (shape.kind === 'mesh') return meshSolid(Data.meshes[shape.mesh], shape.solid);
    const piece = { radius: shape.kind === 'sphere' || shape.kind === 'capsule' ? shape.radius : 0, support: SUPPORTS[shape.kind](shape) };
    const low = [0, 1, 2].map((k) => piece.support([0, 1, 2].map((i) => (i === k ? -1 : 0)))[k] - piece.radius);
    const high = [0, 1, 2].map((k) => piece.support([0, 1, 2].map((i) => (i === k ? 1 : 0)))[k] + piece.radius);
    return { root: { ...box(low, high), pieces: [piece] } };
  }

  const box = (low, high) => ({
    middle: [0, 1, 2].map((k) => (low[k] + high[k]) / 2),
    half: [0, 1, 2].map((k) => (high[k] - low[k]) / 2),
  });

  function meshSolid({ v, i }, hasInterior) {
    const corner = (t, k) => v.subarray(3 * i[3 * t + k], 3 * i[3 * t + k] + 3);
    const triangle = (t) => {
      const [a, b, c] = [0, 1, 2].map((k) => corner(t, k));
      const support = (d) => {
        const [x, y, z] = [dot(a, d), dot(b, d), dot(c, d)];
        return x >= y && x >= z ? a : y >= z ? b : c;
      };
      return { radius: 0, support };
    };
    // Splits at the middle of the centroids along the longest side.
    const build = (list) => {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (const t of list) for (let k = 0; k < 9; k++) {
        const axis = k % 3, x = v[3 * i[3 * t + (k - axis) / 3] + axis];
        if (x < low[axis]) low[axis] = x;
        if (x > high[axis]) high[axis] = x;
      }
      const node = box(low, high);
      if (list.length <= LEAF) {
        // Made when they are first needed: most triangles never are.
        let made = null;
        return { ...node, get pieces() { return (made ||= list.map(triangle)); } };
      }
      const axis = node.half.indexOf(Math.max(...node.half));
      const at = (t) => v[3 * i[3 * t] + axis] + v[3 * i[3 * t + 1] + axis] + v[3 * i[3 * t + 2] + axis];
      const sides = [[], []];
      for (const t of list) sides[at(t) < 3 * node.middle[axis] ? 0 : 1].push(t);
      const isSplit = sides[0].length && sides[1].length;
      const half = list.length >> 1;
      return { ...node, children: (isSplit ? sides : [list.slice(0, half), list.slice(half)]).map(build) };
    };
    const triangles = Array.from({ length: i.length / 3 }, (_, t) => t);
    return { root: build(triangles), v, inside: hasInterior ? (p) => inside(v, i, p) : null, first: v.subarray(0, 3) };
  }

  // Whether a closed surface winds around a point: the sum of the solid angles of its triangles (van Oosterom and Strackee).
  function inside(v, i, p) {
    let sum = 0;
    for (let t = 0; t < i.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => minus(v.subarray(3 * i[t + k], 3 * i[t + k] + 3), p));
      const [la, lb, lc] = [Math.hypot(...a), Math.hypot(...b), Math.hypot(...c)];
      const volume = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
      sum += 2 * Math.atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return Math.abs(sum) > 2 * Math.PI;
  }

  // The point of the simplex closest to the origin, over all subsets with its newest vertex: weights by vertex.
  function closestOf(vertices) {
    const newest = vertices.length - 1, o = vertices[newest].w;
    let best = null;
    for (let mask = 0; mask < 1 << newest; mask++) {
      const others = [];
      for (let k = 0; k < newest; k++) if (mask & (1 << k)) others.push(k);
      const weights = affine(o, others.map((k) => minus(vertices[k].w, o)));
      if (!weights) continue;
      const used = [newest, ...others].map((k, n) => ({ vertex: vertices[k], weight: weights[n] }));
      const v = [0, 1, 2].map((axis) => used.reduce((sum, u) => sum + u.weight * u.vertex.w[axis], 0));
      const square = dot(v, v);
      if (!best || square < best.square) best = { v, square, used };
    }
    return best;
  }

  // Weights of o and of o + each edge at the point of their affine hull closest to the origin; null where one is negative.
  function affine(o, edges) {
    const n = edges.length;
    const b = edges.map((e) => -dot(e, o));
    const g = edges.map((e) => edges.map((f) => dot(e, f)));
    let t;
    if (n === 0) t = [];
    else if (n === 1) t = g[0][0] > 0 ? [b[0] / g[0][0]] : null;
    else if (n === 2) {
      const det = g[0][0] * g[1][1] - g[0][1] * g[0][1];
      t = det > 1e-14 * g[0][0] * g[1][1] ? [(b[0] * g[1][1] - b[1] * g[0][1]) / det, (b[1] * g[0][0] - b[0] * g[0][1]) / det] : null;
    } else {
      // Four points span space: the origin itself, by Cramer's rule on the edges.
      const [e, f, h] = edges;
      const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
      const fh = cross(f, h), det = dot(e, fh);
      const size = Math.sqrt(g[0][0] * g[1][1] * g[2][2]);
      const r = [-o[0], -o[1], -o[2]];
      t = Math.abs(det) > 1e-12 * size ? [dot(r, fh) / det, dot(r, cross(h, e)) / det, dot(r, cross(e, f)) / det] : null;
    }
    if (!t) return null;
    const first = 1 - t.reduce((sum, x) => sum + x, 0);
    return first >= 0 && t.every((x) => x >= 0) ? [first, ...t] : null;
  }

  // Between two pieces at their poses: distance and the nearest points; null where it is certainly beyond the limit.
  function pieces(a, inWorldA, b, inWorldB, limit) {
    const radii = a.radius + b.radius;
    const support = (d) => {
      const onA = apply(inWorldA, a.support(unrotate(inWorldA, d)));
      const onB = apply(inWorldB, b.support(unrotate(inWorldB, [-d[0], -d[1], -d[2]])));
      return { w: minus(onA, onB), onA, onB };
    };
    const start = minus([inWorldB[9], inWorldB[10], inWorldB[11]], [inWorldA[9], inWorldA[10], inWorldA[11]]);
    let used = [{ vertex: support(dot(start, start) > 0 ? start : [1, 0, 0]), weight: 1 }];
    let v = used[0].vertex.w, square = dot(v, v);
    for (let step = 0; step < MAX_STEPS; step++) {
      const length = Math.sqrt(square);
      if (length <= CONTACT) break;
      const next = support([-v[0], -v[1], -v[2]]);
      const proven = dot(v, next.w) / length;
      if (proven - radii > limit) return null;
      if (length - proven <= AGREED) break;
      const vertices = used.map((u) => u.vertex);
      if (vertices.some((u) => u.w[0] === next.w[0] && u.w[1] === next.w[1] && u.w[2] === next.w[2])) break;
      const best = closestOf([...vertices, next]);
      if (best.square >= square) break;
      ({ used, v, square } = { used: best.used, v: best.v, square: best.square });
    }
    const length = Math.sqrt(square);
    const at = (side) => [0, 1, 2].map((k) => used.reduce((sum, u) => sum + u.weight * u.vertex[side][k], 0));
    const [onA, onB] = [at('onA'), at('onB')];
    const distance = length <= CONTACT ? 0 : Math.max(0, length - radii);
    const move = (p, r) => p.map((x, k) => x + (length > CONTACT ? (r * v[k]) / length : 0));
    return { distance, onA: move(onA, -a.radius), onB: move(onB, b.radius) };
  }

  // Distance of two boxes, the first one replaced by its box along the axes of the second.
  function gap(a, aInB, b) {
    const middle = apply(aInB, a.middle);
    let square = 0;
    for (let k = 0; k < 3; k++) {
      const half = Math.abs(aInB[3 * k]) * a.half[0] + Math.abs(aInB[3 * k + 1]) * a.half[1] + Math.abs(aInB[3 * k + 2]) * a.half[2];
      const apart = Math.abs(middle[k] - b.middle[k]) - half - b.half[k];
      if (apart > 0) square += apart * apart;
    }
    return Math.sqrt(square);
  }

  // From a half-space below the plane z = 0 of its frame.
  function toPlane(a, inWorldA, plane) {
    const normal = [plane[2], plane[5], plane[8]];
    const down = unrotate(inWorldA, normal).map((x) => -x);
    const piece = a.v ? null : a.root.pieces[0];
    let onA = apply(inWorldA, piece ? piece.support(down) : farthest(a.v, 0, a.v.length, down));
    if (piece) onA = onA.map((x, k) => x - piece.radius * normal[k]);
    const height = dot(minus(onA, [plane[9], plane[10], plane[11]]), normal);
    return { distance: Math.max(0, height), onA, onB: onA.map((x, k) => x - height * normal[k]) };
  }

  // Distance of two solids at their poses, with the nearest points; null where it is beyond the limit.
  function between(a, inWorldA, b, inWorldB, limit = Infinity) {
    if (b.plane) return toPlane(a, inWorldA, inWorldB);
    const aInB = relative(inWorldB, inWorldA);
    let best = null, least = limit;
    const visit = (m, n) => {
      if (gap(m, aInB, n) > least || least === 0) return;
      if (m.pieces && n.pieces) {
        for (const p of m.pieces) for (const q of n.pieces) {
          const found = pieces(p, inWorldA, q, inWorldB, least);
          if (found && (found.distance < least || !best)) { best = found; least = found.distance; }
        }
        return;
      }
      const size = (node) => node.half[0] + node.half[1] + node.half[2];
      const splitsFirst = !n.children || (m.children && size(m) > size(n));
      const pairs = splitsFirst ? m.children.map((c) => [c, n]) : n.children.map((c) => [m, c]);
      pairs.map(([x, y]) => ({ x, y, apart: gap(x, aInB, y) })).sort((x, y) => x.apart - y.apart).forEach(({ x, y }) => visit(x, y));
    };
    visit(a.root, b.root);
    if (least > 0 && encloses(a, inWorldA, b, inWorldB)) {
      const at = [inWorldA[9], inWorldA[10], inWorldA[11]];
      return { distance: 0, onA: at, onB: at };
    }
    return best;
  }

  // Surfaces apart: whether one solid is inside the closed mesh of the other.
  function encloses(a, inWorldA, b, inWorldB) {
    const isIn = (outer, outerPose, inner, innerPose) => {
      if (!outer.inside) return false;
      const local = inner.v ? inner.first : inner.root.pieces[0].support([1, 0, 0]);
      const p = apply(relative(outerPose, innerPose), local);
      const { middle, half } = outer.root;
      return p.every((x, k) => Math.abs(x - middle[k]) <= half[k]) && outer.inside(p);
    };
    return isIn(b, inWorldB, a, inWorldA) || isIn(a, inWorldA, b, inWorldB);
  }

  return { solid, between };
})();
