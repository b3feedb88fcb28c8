// The data of the page: deflated texts, and arrays of quantised numbers.
if (!Inflate.works) {
  const note = document.getElementById('unsupported');
  note.textContent = 'The scene and the plots need a browser of 2023 or later.';
  note.hidden = false;
  return;
}

const Data = await (async () => {
  const [figures, scene, arrays] = await Promise.all([
    Inflate.text('plot-data'), Inflate.text('scene-data'), Inflate.bytes('array-data'), Inflate.library('plotly'), Inflate.library('three'),
  ]);

  const read = (entry) => Packing.read(arrays, entry);
  const data = JSON.parse(scene);
  data.meshes = data.meshes.map(({ v, i }) => ({ v: read(v), i: Uint32Array.from(read(i)) }));
  for (const run of data.runs) {
    run.t = read(run.t);
    for (const robot of run.robots) {
      for (const key of ['q', 'override', 'speed', 'distance', 'region', 'obstacle', 'reason']) robot[key] = read(robot[key]);
    }
    for (const region of run.regions) region.poses = read(region.poses);
    for (const object of run.objects) object.poses = object.poses && read(object.poses);
  }
  return { ...data, figures: JSON.parse(figures) };
})();
