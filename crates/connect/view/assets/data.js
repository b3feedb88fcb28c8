// A document of the program, and how meshes of its arrays are read.
function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const data = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays = new Uint8Array(buffer, 4 + length);
  const read = (entry) => Packing.read(arrays, entry);
  return { data, mesh: ({ v, i }) => ({ v: read(v), i: Uint32Array.from(read(i)) }) };
}

// The geometry of the cell, fetched once.
const Data = await (async () => {
  let response;
  try {
    response = await fetch('/geometry', { headers: { Authorization: `Bearer ${Link.token}` } });
  } catch (error) {
    Link.setState('closed', 'The program does not answer. Start it again, and open the address that it prints.');
    return null;
  }
  if (!response.ok) {
    Link.setState('refused', 'The token in the address of this page is missing or another one. Open the address that the program has printed.');
    return null;
  }
  const { data, mesh } = unpack(await response.arrayBuffer());
  data.meshes = data.meshes.map(mesh);
  return data;
})();
if (!Data) return;
