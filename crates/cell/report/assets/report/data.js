// The data of the page: deflated texts, and arrays of quantised numbers.
if (typeof DecompressionStream === 'undefined') {
  const note = document.getElementById('unsupported');
  note.textContent = 'The scene and the plots need a browser of 2023 or later.';
  note.hidden = false;
  return;
}

const Data = await (async () => {
  // A <script type="text/plain"> with raw deflate in base64.
  async function inflate(id) {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }
  const text = async (id) => new TextDecoder().decode(await inflate(id));

  // A library that defines a global.
  async function load(id) {
    const script = document.createElement('script');
    script.textContent = await text(id);
    document.head.append(script);
  }

  const [figures, scene, arrays] = await Promise.all([text('plot-data'), text('scene-data'), inflate('array-data'), load('plotly'), load('three')]);

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
