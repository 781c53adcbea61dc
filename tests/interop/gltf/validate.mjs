// Khronos' validator over GLB and glTF files: no error, no warning, no hint but those that `allowed` names.
//
//   node validate.mjs FILE...
import fs from 'node:fs';
import path from 'node:path';
import { validateBytes, version } from 'gltf-validator';

// Extensions that we write and that this validator does not look into; three.js and the tests of the crate do.
const UNKNOWN = ['EXT_mesh_gpu_instancing', 'EXT_meshopt_compression', 'MSFT_lod'];

const files = process.argv.slice(2);
if (files.length === 0) throw new Error('usage: validate.mjs FILE...');

let triangles = 0;
const skipped = new Set();
let failed = false;
for (const file of files) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const document = json(bytes);
  // What is beside the document is looked at, too: length of buffers, kind and size of images.
  const externalResourceFunction = async (uri) =>
    new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))));
  const report = await validateBytes(bytes, { maxIssues: 0, externalResourceFunction });
  triangles += report.info.totalTriangleCount ?? 0;
  for (const issue of report.issues.messages.filter((issue) => !allowed(issue, document))) {
    console.error(`${path.basename(file)}: ${issue.severity} ${issue.code} at ${issue.pointer ?? 'file'}: ${issue.message}`);
    failed = true;
  }
  if (!report.info.totalTriangleCount) {
    console.error(`${path.basename(file)}: holds no triangles`);
    failed = true;
  }
}
if (failed) process.exit(1);
const unseen = skipped.size ? `, not looking into ${[...skipped].sort().join(', ')}` : '';
console.log(`gltf-validator ${version()}: ${files.length} files, ${triangles} triangles, no issues${unseen}`);

function allowed({ code, pointer }, document) {
  switch (code) {
    // At a density of texels the side of a map follows from its chunk, in steps of 64 px. Any GPU since OpenGL 2 takes that.
    case 'IMAGE_NPOT_DIMENSIONS':
      return true;
    // Tiles share their images.
    case 'URI_GLB':
      return pointer.startsWith('/images/');
    case 'UNSUPPORTED_EXTENSION': {
      const name = at(document, pointer);
      if (!UNKNOWN.includes(name)) return false;
      skipped.add(name);
      return true;
    }
    // What only an extension names: coarser levels, nodes outside of the scene; buffers that are unpacked; places of instances.
    case 'UNUSED_OBJECT':
      return named(document).has(pointer);
    default:
      return false;
  }
}

/** Pointers to what extensions name. */
function named(document) {
  const levels = document.nodes.flatMap((node) => node.extensions?.MSFT_lod?.ids ?? []);
  const packed = document.bufferViews.map((view) => view.extensions?.EXT_meshopt_compression?.buffer);
  const placed = document.nodes.flatMap((node) => Object.values(node.extensions?.EXT_mesh_gpu_instancing?.attributes ?? {}));
  return new Set([
    ...levels.map((id) => `/nodes/${id}`),
    ...packed.map((id) => `/buffers/${id}`),
    ...placed.map((id) => `/accessors/${id}`),
  ]);
}

/** What a JSON pointer points to. */
function at(document, pointer) {
  return pointer.split('/').slice(1).reduce((part, key) => part?.[key], document);
}

/** The JSON of a document, which in a GLB follows twenty bytes, the last eight of which tell its length. */
function json(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const isBinary = view.getUint32(0, true) === 0x46546c67;
  return JSON.parse(new TextDecoder().decode(isBinary ? bytes.subarray(20, 20 + view.getUint32(12, true)) : bytes));
}
