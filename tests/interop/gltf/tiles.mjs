// Streams a package of 3D Tiles with 3DTilesRendererJS (three.js) in headless Chromium.
//
//   node tiles.mjs PACKAGE_DIR --out PICTURE.png
//
// From afar every chunk is there, with fewer triangles than in full detail; from the first start pose what is near is in full
// detail, and the picture shows rock everywhere; where no error is allowed, every chunk has the triangles that the manifest lists.
// No vertex is outside the bounding volume of its tile or of those above it.
import path from 'node:path';
import { faultsOfPicture, judge } from './browser.mjs';

// From afar, the whole cave has at most this share of its triangles. A mine, most of whose triangles are things, has 0.8: things have
// fewer levels than walls.
const COARSE_SHARE = 0.9;

const [folder, flag, out] = process.argv.slice(2);
if (!folder || flag !== '--out' || !out) throw new Error('usage: tiles.mjs PACKAGE_DIR --out PICTURE.png');

const here = import.meta.dirname;
const modules = (name) => path.join(here, 'node_modules', name);
await judge({
  folders: { package: path.resolve(folder), page: here, three: modules('three'), tiles: modules('3d-tiles-renderer') },
  page: 'page/tiles.html',
  out,
  verify,
  summary: ({ overview, inside, full, picture }) =>
    `3DTilesRendererJS: ${overview.files.length} tiles of ${overview.triangles} triangles from afar, ` +
    `${inside.files.length} of ${inside.triangles} from inside, ${full.files.length} of ${full.triangles} in full detail; ` +
    `mean brightness ${picture.mean.toFixed(3)}, contrast ${picture.deviation.toFixed(3)}`,
});

function verify({ overview, inside, full, picture, outside, wanted }) {
  const faults = faultsOfPicture(picture);
  const all = wanted.reduce((sum, triangles) => sum + triangles, 0);
  const isFull = (file) => file.endsWith('_LOD0.glb');
  if (overview.files.length !== wanted.length) faults.push(`from afar ${overview.files.length} of ${wanted.length} chunks are drawn`);
  if (overview.triangles > COARSE_SHARE * all) faults.push(`from afar ${overview.triangles} of ${all} triangles are drawn`);
  if (!inside.files.some(isFull)) faults.push('from inside nothing is drawn in full detail');
  if (!full.files.every(isFull)) faults.push(`${full.files.find((file) => !isFull(file))} is drawn where no error is allowed`);
  if (full.triangles !== all) faults.push(`there are ${full.triangles} triangles, and the manifest lists ${all}`);
  faults.push(...outside);
  return faults;
}
