// Renders a package of glTF or FBX from a spawn pose (the first if none is named) with three.js in headless Chromium, a headlamp
// at the eye.
//
//   node shot.mjs PACKAGE_DIR --out PICTURE.png [--spawn N]
//
// Fails if a mesh, a texture or a colour space is missing, or the picture is dark or flat: an inside-out or unlit cave.
import fs from 'node:fs';
import path from 'node:path';
import { faultsOfPicture, judge } from './browser.mjs';

const EYE_M = 1.0;
// What each reader makes of a material. three.js reads neither roughness nor tangents from FBX.
const MAPS = { gltf: ['map', 'normalMap', 'roughnessMap', 'aoMap'], fbx: ['map', 'normalMap', 'aoMap'] };

const [folder, flag, out, , spawn = '0'] = process.argv.slice(2);
if (!folder || flag !== '--out' || !out) throw new Error('usage: shot.mjs PACKAGE_DIR --out PICTURE.png [--spawn N]');

const here = import.meta.dirname;
const fbx = filesOf(folder, '.fbx').concat(filesOf(path.join(folder, 'chunks'), '.fbx'));
const format = fbx.length ? 'fbx' : 'gltf';
const query = new URLSearchParams({ eye: EYE_M, spawn: Number(spawn), fbx: JSON.stringify(fbx) });
await judge({
  folders: { package: path.resolve(folder), three: path.join(here, 'node_modules/three'), page: here },
  page: `page/shot.html?${query}`,
  out,
  verify,
  summary: ({ revision, meshes, triangles, mean, deviation }) =>
    `three.js ${revision}: ${meshes.length} meshes, ${triangles} triangles drawn, ` +
    `mean brightness ${mean.toFixed(3)}, contrast ${deviation.toFixed(3)}`,
});

function filesOf(place, ending) {
  if (!fs.existsSync(place)) return [];
  const files = fs.readdirSync(place).filter((file) => file.endsWith(ending)).sort();
  return files.map((file) => path.relative(folder, path.join(place, file)));
}

function verify(report) {
  const faults = [];
  if (report.meshes.length === 0) faults.push('there are no meshes');
  for (const mesh of report.meshes) {
    if (format === 'gltf' && !mesh.tangents) faults.push(`${mesh.name} has no tangents`);
    for (const map of MAPS[format]) {
      if (!mesh.maps[map]) faults.push(`${mesh.name} has no ${map}`);
    }
    if (mesh.maps.map && mesh.maps.map !== 'srgb') faults.push(`${mesh.name}: base colour is not sRGB`);
  }
  for (const [name, triangles, found] of report.counted) {
    if (found !== triangles) faults.push(`${name} has ${found} triangles, and scene.json says ${triangles}`);
  }
  faults.push(...faultsOfPicture(report));
  return faults;
}
