// Surfaces of the scene: geometries, coarser ones for the same surfaces, and a material for slow computers.
const Surfaces = (() => {
  // Vertex normals are shared where faces meet at less than 40 degrees and split elsewhere: smooth surfaces, sharp edges.
  function geometry({ v, i: index }) {
    const faces = index.length / 3;
    const normals = new Float32Array(index.length);
    const around = new Map();
    const a = new THREE.Vector3(), b = new THREE.Vector3(), c = new THREE.Vector3();
    for (let f = 0; f < faces; f++) {
      a.fromArray(v, 3 * index[3 * f]);
      b.fromArray(v, 3 * index[3 * f + 1]).sub(a);
      c.fromArray(v, 3 * index[3 * f + 2]).sub(a);
      b.cross(c).toArray(normals, 3 * f);
      for (let k = 0; k < 3; k++) {
        const corner = index[3 * f + k];
        if (around.has(corner)) around.get(corner).push(f);
        else around.set(corner, [f]);
      }
    }
    const position = new Float32Array(9 * faces);
    const normal = new Float32Array(9 * faces);
    for (let f = 0; f < faces; f++) {
      a.fromArray(normals, 3 * f);
      const size = a.length();
      for (let k = 0; k < 3; k++) {
        const corner = index[3 * f + k];
        c.set(0, 0, 0);
        for (const other of around.get(corner)) {
          b.fromArray(normals, 3 * other);
          if (a.dot(b) >= 0.766 * size * b.length()) c.add(b);
        }
        c.normalize().toArray(normal, 9 * f + 3 * k);
        position.set(v.subarray(3 * corner, 3 * corner + 3), 9 * f + 3 * k);
      }
    }
    const out = new THREE.BufferGeometry();
    out.setAttribute('position', new THREE.BufferAttribute(position, 3));
    out.setAttribute('normal', new THREE.BufferAttribute(normal, 3));
    return out;
  }

  // Three numbers up to this are one number of a script.
  const MOST = 2 ** 17;

  // Whether a surface has an outside only: every edge leads back along another triangle, and it contains something.
  function isClosed({ v, i: index }) {
    const edges = new Set(), count = v.length / 3;
    let volume = 0;
    const [a, b, c] = Array.from({ length: 3 }, () => new THREE.Vector3());
    for (let f = 0; f < index.length; f += 3) {
      const corners = index.slice(f, f + 3);
      [a, b, c].forEach((point, k) => point.fromArray(v, 3 * corners[k]));
      volume += a.dot(b.cross(c));
      for (let k = 0; k < 3; k++) {
        const [from, to] = [corners[k], corners[(k + 1) % 3]], back = to * count + from;
        if (!edges.delete(back)) edges.add(from * count + to);
      }
    }
    return !edges.size && volume > 0;
  }

  // Numbers corners by the cube of a grid in which they are; returns the number per corner, and the mean corner of each cube.
  function clusters(position, low, step) {
    const numbers = new Map(), of = new Uint32Array(position.length / 3), sums = [], counts = [];
    const place = (c, k) => Math.floor((position[3 * c + k] - low[k]) / step);
    for (let c = 0; c < of.length; c++) {
      const cube = (place(c, 0) * MOST + place(c, 1)) * MOST + place(c, 2);
      let number = numbers.get(cube);
      if (number === undefined) {
        number = counts.length;
        numbers.set(cube, number);
        sums.push(0, 0, 0);
        counts.push(0);
      }
      for (let k = 0; k < 3; k++) sums[3 * number + k] += position[3 * c + k];
      counts[number] += 1;
      of[c] = number;
    }
    return { of, mean: sums.map((sum, k) => sum / counts[Math.floor(k / 3)]) };
  }

  // The surface without details smaller than a step: the corners in each cube of a grid become one. It keeps the normals, so that
  // it is shaded as before.
  function coarser(fine, step) {
    const { position, normal } = fine.attributes, { min, max } = fine.boundingBox;
    if (max.distanceTo(min) / step > MOST) return fine;
    const { of, mean } = clusters(position.array, min.toArray(), step);
    if (mean.length / 3 > MOST) return fine;
    const kept = new Set(), positions = [], normals = [];
    const [a, b, c, out] = Array.from({ length: 4 }, () => new THREE.Vector3());
    for (let first = 0; first < of.length; first += 3) {
      const corners = [first, first + 1, first + 2], cubes = corners.map((corner) => of[corner]);
      if (cubes[0] === cubes[1] || cubes[1] === cubes[2] || cubes[2] === cubes[0]) continue;
      out.set(0, 0, 0);
      corners.forEach((corner) => out.add(c.fromArray(normal.array, 3 * corner)));
      [a, b, c].forEach((point, k) => point.fromArray(mean, 3 * cubes[k]));
      // A triangle that the merging has turned over is turned back.
      const order = b.sub(a).cross(c.sub(a)).dot(out) < 0 ? [0, 2, 1] : [0, 1, 2];
      // The same triangle, whichever corner is its first; its other side is another one.
      const least = order.reduce((best, k, at) => (cubes[k] < cubes[order[best]] ? at : best), 0);
      const [i, j, k] = [0, 1, 2].map((at) => cubes[order[(least + at) % 3]]), key = (i * MOST + j) * MOST + k;
      if (kept.has(key)) continue;
      kept.add(key);
      for (const k of order) {
        positions.push(...mean.slice(3 * cubes[k], 3 * cubes[k] + 3));
        normals.push(...normal.array.subarray(3 * corners[k], 3 * corners[k] + 3));
      }
    }
    const coarse = new THREE.BufferGeometry();
    coarse.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
    coarse.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(normals), 3));
    return coarse;
  }

  function area(geometry) {
    const { array } = geometry.attributes.position;
    const [a, b, c] = Array.from({ length: 3 }, () => new THREE.Vector3());
    let sum = 0;
    for (let f = 0; f < array.length; f += 9) {
      [a, b, c].forEach((point, k) => point.fromArray(array, f + 3 * k));
      sum += b.sub(a).cross(c.sub(a)).length();
    }
    return sum;
  }

  // Coarser surfaces are not worth it for fewer triangles, nor if they have not fewer than a share of them, nor good enough if
  // they have not a share of the area: a thin rod would vanish.
  const FEW = 100, FEWER = 0.8, KEPT = 0.6, FINEST_M = 1e-3, COARSEST = 12;

  // Geometries of a mesh, from which `at` chooses by the size of details that are not seen, m.
  function levels(mesh) {
    const fine = geometry(mesh), size = area(fine), made = [];
    const triangles = (g) => g.attributes.position.count / 3;
    function make(level) {
      const coarse = coarser(fine, FINEST_M * 2 ** level);
      if (coarse === fine || triangles(coarse) > FEWER * triangles(fine)) return fine;
      return area(coarse) < KEPT * size ? from(level - 1) : coarse;
    }
    const from = (level) => (level >= 0 ? (made[level] ||= make(level)) : fine);
    const at = (unseen) => (triangles(fine) < FEW ? fine : from(Math.min(COARSEST, Math.round(Math.log2(unseen / FINEST_M)))));
    fine.computeBoundingBox();
    fine.computeBoundingSphere();
    return { fine, at, isClosed: isClosed(mesh), center: fine.boundingSphere.center, radius: fine.boundingSphere.radius };
  }

  // The light of `MeshLambertMaterial`, computed per corner instead of per pixel.
  const VERTEX = `
    #include <common>
    #include <lights_pars_begin>
    uniform vec3 diffuse;
    uniform vec3 emissive;
    varying vec3 front;
    #ifdef DOUBLE_SIDED
      varying vec3 back;
    #endif
    vec3 lit(vec3 normal) {
      vec3 light = directionalLights[0].color * saturate(dot(normal, directionalLights[0].direction));
      light += getHemisphereLightIrradiance(hemisphereLights[0], normal);
      vec3 sum = min(emissive + RECIPROCAL_PI * diffuse * light, vec3(1.0));
      return mix(1.055 * pow(sum, vec3(1.0 / 2.4)) - 0.055, 12.92 * sum, vec3(lessThanEqual(sum, vec3(0.0031308))));
    }
    void main() {
      vec3 turned = normalize(normalMatrix * normal);
      front = lit(turned);
      #ifdef DOUBLE_SIDED
        back = lit(-turned);
      #endif
      gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
    }`;
  const FRAGMENT = `
    uniform float opacity;
    varying vec3 front;
    #ifdef DOUBLE_SIDED
      varying vec3 back;
      void main() { gl_FragColor = vec4(gl_FrontFacing ? front : back, opacity); }
    #else
      void main() { gl_FragColor = vec4(front, opacity); }
    #endif`;
  function perCorner(look) {
    const material = new THREE.MeshLambertMaterial(look);
    material.onBeforeCompile = (shader) => Object.assign(shader, { vertexShader: VERTEX, fragmentShader: FRAGMENT });
    return material;
  }

  return { geometry, levels, perCorner };
})();
