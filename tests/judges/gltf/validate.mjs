// Khronos' validator over GLB files: no error, no warning, no hint unless it is one of ALLOWED.
//
//   node validate.mjs FILE.glb...
import fs from 'node:fs';
import path from 'node:path';
import { validateBytes, version } from 'gltf-validator';

// At a density of texels the side of a map follows from its chunk, in steps of 64 px. Any GPU since OpenGL 2 takes that.
const ALLOWED = ['IMAGE_NPOT_DIMENSIONS'];

const files = process.argv.slice(2);
if (files.length === 0) throw new Error('usage: validate.mjs FILE.glb...');

let triangles = 0;
let failed = false;
for (const file of files) {
  const report = await validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20, ignoredIssues: ALLOWED });
  triangles += report.info.totalTriangleCount ?? 0;
  for (const { code, message, pointer, severity } of report.issues.messages) {
    console.error(`${path.basename(file)}: ${severity} ${code} at ${pointer ?? 'file'}: ${message}`);
    failed = true;
  }
  if (!report.info.totalTriangleCount) {
    console.error(`${path.basename(file)}: holds no triangles`);
    failed = true;
  }
}
if (failed) process.exit(1);
console.log(`gltf-validator ${version()}: ${files.length} files, ${triangles} triangles, no issues`);
