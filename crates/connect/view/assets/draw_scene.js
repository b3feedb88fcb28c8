// What is drawn on an object, in the 3-D scene: points, the line along the surface, a drill, a radius, and the shield.
const DrawScene = (() => {
  const { stage } = Scene;
  const COLOR = '#e8590c', SHIELD = '#1098ad';
  let shown = [], shield = null;

  function put(thing, order) {
    thing.renderOrder = order;
    thing.frustumCulled = false;
    stage.add(thing);
    shown.push(thing);
    return thing;
  }
  function drop(thing) {
    stage.remove(thing);
    thing.geometry.dispose();
    thing.material.dispose();
  }

  const ball = (point, radius, material) => {
    const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 24, 16), new THREE.MeshBasicMaterial({ color: COLOR, ...material }));
    mesh.position.set(...point);
    return mesh;
  };
  function line(points) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points.flat()), 3));
    return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: COLOR, depthTest: false }));
  }

  // Shows points of the world as balls of a size, a line through points of the surface, the way of a drill, and a radius about the first point.
  function show({ points, size, along, drill, radius }) {
    if (!stage.works) return;
    shown.forEach(drop);
    shown = [];
    points.forEach((p) => put(ball(p, size, { depthTest: false }), 8));
    if (along.length > 1) put(line(along), 7);
    if (drill) put(line(drill), 7);
    if (radius && points.length) put(ball(points[0], radius, { transparent: true, opacity: 0.25, depthWrite: false }), 4);
    stage.request();
  }

  // Shows a shield, or none.
  function showShield(mesh) {
    if (!stage.works) return;
    if (shield) drop(shield);
    shield = mesh && stage.shaded(mesh, SHIELD);
    if (shield) stage.add(shield);
    stage.request();
  }

  return { show, showShield };
})();
