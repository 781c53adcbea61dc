// Renders a package of glTF or FBX from a spawn pose (the first if none is named) with three.js in headless Chromium, a headlamp
// at the eye.
//
//   node shot.mjs PACKAGE_DIR --out PICTURE.png [--spawn N]
//
// Fails if a mesh, a texture or a colour space is missing, or the picture is dark or flat: an inside-out or unlit cave.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import puppeteer from 'puppeteer-core';

const WIDTH = 960;
const HEIGHT = 540;
const EYE_M = 1.0;
const TIMEOUT_MS = 600_000;
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const FLAGS = ['--no-sandbox', '--headless=new', '--use-gl=angle', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const TYPES = { '.js': 'text/javascript', '.html': 'text/html', '.json': 'application/json', '.glb': 'model/gltf-binary' };
// What each reader makes of a material. three.js reads neither roughness nor tangents from FBX.
const MAPS = { gltf: ['map', 'normalMap', 'roughnessMap', 'aoMap'], fbx: ['map', 'normalMap', 'aoMap'] };

const [folder, flag, out, , spawn = '0'] = process.argv.slice(2);
if (!folder || flag !== '--out' || !out) throw new Error('usage: shot.mjs PACKAGE_DIR --out PICTURE.png [--spawn N]');

const here = import.meta.dirname;
const fbx = filesOf(folder, '.fbx').concat(filesOf(path.join(folder, 'chunks'), '.fbx'));
const format = fbx.length ? 'fbx' : 'gltf';
const roots = { package: path.resolve(folder), three: path.join(here, 'node_modules/three'), page: here };
const server = http.createServer(serve).listen(0, '127.0.0.1');
const browser = await puppeteer.launch({
  executablePath: CHROMIUM.find((file) => fs.existsSync(file)),
  args: FLAGS,
  protocolTimeout: TIMEOUT_MS, // a large scene keeps the page busy for minutes on a CPU
});
try {
  const page = await browser.newPage();
  await page.setViewport({ width: WIDTH, height: HEIGHT });
  const query = new URLSearchParams({ eye: EYE_M, spawn: Number(spawn), fbx: JSON.stringify(fbx) });
  const address = `http://127.0.0.1:${server.address().port}/page/shot.html?${query}`;
  await page.goto(address);
  await page.waitForFunction('window.report', { timeout: TIMEOUT_MS });
  const report = await page.evaluate('window.report');
  await page.screenshot({ path: out });
  const faults = verify(report);
  if (faults.length) throw new Error(faults.join('; '));
  console.log(`three.js ${report.revision}: ${report.meshes.length} meshes, ${report.triangles} triangles drawn, ` +
    `mean brightness ${report.mean.toFixed(3)}, contrast ${report.deviation.toFixed(3)}`);
} catch (error) {
  console.error(`error: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
  server.close();
}

function filesOf(place, ending) {
  if (!fs.existsSync(place)) return [];
  const files = fs.readdirSync(place).filter((file) => file.endsWith(ending)).sort();
  return files.map((file) => path.relative(folder, path.join(place, file)));
}

function serve(request, response) {
  const [, root, ...rest] = decodeURIComponent(new URL(request.url, 'http://localhost').pathname).split('/');
  const file = roots[root] && path.join(roots[root], ...rest);
  if (!file?.startsWith(roots[root]) || !fs.existsSync(file)) return response.writeHead(404).end();
  response.setHeader('content-type', TYPES[path.extname(file)] ?? 'application/octet-stream');
  fs.createReadStream(file).pipe(response);
}

function verify(report) {
  if (report.error) return [report.error];
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
  if (report.mean < 0.02) faults.push(`the picture is dark (mean ${report.mean.toFixed(4)})`);
  if (report.deviation < 0.01) faults.push(`the picture is flat (deviation ${report.deviation.toFixed(4)})`);
  if (report.background > 0.01) faults.push(`${(100 * report.background).toFixed(1)} % of the view is not rock`);
  return faults;
}
