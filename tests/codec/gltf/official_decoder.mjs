// Unfolds buffer views by the decoder that three.js ships. Standard input: {module, content: base64, views: [...]}.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const asked = JSON.parse(readFileSync(0, "utf8"));
const { MeshoptDecoder } = await import(pathToFileURL(asked.module));
await MeshoptDecoder.ready;
const content = Buffer.from(asked.content, "base64");
const unfolded = asked.views.map(({ byteOffset, byteLength, count, byteStride, mode, filter }) => {
  const target = new Uint8Array(count * byteStride);
  const source = new Uint8Array(content.subarray(byteOffset, byteOffset + byteLength));
  MeshoptDecoder.decodeGltfBuffer(target, count, byteStride, source, mode, filter);
  return Buffer.from(target).toString("base64");
});
process.stdout.write(JSON.stringify(unfolded));
