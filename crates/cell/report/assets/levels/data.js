// The robot and the boxes of its levels.
if (!Inflate.works) {
  byId('unsupported').textContent = 'The picture needs a browser of 2023 or later.';
  byId('unsupported').hidden = false;
  return;
}

const Data = await (async () => {
  const [scene, arrays] = await Promise.all([Inflate.text('scene-data'), Inflate.bytes('array-data'), Inflate.library('three')]);
  const data = JSON.parse(scene);
  data.meshes = data.meshes.map(({ v, i }) => ({ v: Packing.read(arrays, v), i: Uint32Array.from(Packing.read(arrays, i)) }));
  data.levels.forEach((level) => { level.boxes = Packing.read(arrays, level.boxes); });
  return data;
})();
