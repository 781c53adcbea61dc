// Streams a package of 3D Tiles with CesiumJS, by the authors of the format, in headless Chromium.
//
//   node cesium.mjs PACKAGE_DIR --out PICTURE.png
//
// From afar every chunk is there; where no error is allowed, every chunk is there in full detail; and from the first start pose the
// picture shows rock everywhere.
import path from 'node:path';
import { faultsOfPicture, judge } from './browser.mjs';

const [folder, flag, out] = process.argv.slice(2);
if (!folder || flag !== '--out' || !out) throw new Error('usage: cesium.mjs PACKAGE_DIR --out PICTURE.png');

const here = import.meta.dirname;
await judge({
  folders: { package: path.resolve(folder), page: here, cesium: path.join(here, 'node_modules/cesium/Build/Cesium') },
  page: 'page/cesium.html',
  out,
  verify,
  summary: ({ overview, full, picture }) =>
    `CesiumJS: ${overview.length} tiles from afar, ${full.length} in full detail; ` +
    `mean brightness ${picture.mean.toFixed(3)}, contrast ${picture.deviation.toFixed(3)}`,
});

function verify({ asset, overview, full, picture, wanted }) {
  const faults = faultsOfPicture(picture);
  const coarse = full.find((file) => !file.endsWith('_LOD0.glb'));
  if (asset.version !== '1.1') faults.push(`it is of version ${asset.version}`);
  if (overview.length !== wanted.length) faults.push(`from afar ${overview.length} of ${wanted.length} chunks are drawn`);
  if (full.length !== wanted.length) faults.push(`in full detail ${full.length} of ${wanted.length} chunks are drawn`);
  if (coarse) faults.push(`${coarse} is drawn where no error is allowed`);
  return faults;
}
