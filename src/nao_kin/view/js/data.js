// The scene as it stands in the page: a block of JSON and the viewer's commands, deflated together, in base64.

function bytesOf(base64) {
  const binary = atob(base64);
  const result = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) result[i] = binary.charCodeAt(i);
  return result;
}

async function inflated(deflated) {
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function readScene() {
  const { lengths, deflated } = JSON.parse(document.getElementById("scene").textContent);
  const all = await inflated(bytesOf(deflated));
  const parts = [];
  let start = 0;
  for (const length of lengths) {
    parts.push(all.slice(start, start + length));
    start += length;
  }
  const [json, ...commands] = parts;
  return { scene: JSON.parse(new TextDecoder().decode(json)), commands };
}
