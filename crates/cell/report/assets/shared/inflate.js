// Texts and bytes that the page holds deflated, each in a <script type="text/plain"> with raw deflate in base64.
const Inflate = (() => {
  async function bytes(id) {
    const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }
  const text = async (id) => new TextDecoder().decode(await bytes(id));

  // A library that defines a global.
  async function library(id) {
    const script = document.createElement('script');
    script.textContent = await text(id);
    document.head.append(script);
  }

  return { works: typeof DecompressionStream !== 'undefined', bytes, text, library };
})();
