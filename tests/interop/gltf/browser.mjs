// Headless Chromium without a GPU, and a server of folders for its pages.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import puppeteer from 'puppeteer-core';

const [WIDTH, HEIGHT] = [960, 540];
const TIMEOUT_MS = 600_000;
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const FLAGS = ['--no-sandbox', '--headless=new', '--use-gl=angle', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const TYPES = {
  '.css': 'text/css',
  '.js': 'text/javascript',
  '.mjs': 'text/javascript',
  '.html': 'text/html',
  '.json': 'application/json',
  '.glb': 'model/gltf-binary',
};

/// Starts the browser.
export function launch(timeoutMs) {
  return puppeteer.launch({
    executablePath: CHROMIUM.find((file) => fs.existsSync(file)),
    args: FLAGS,
    protocolTimeout: timeoutMs, // a large scene keeps the page busy for minutes on a CPU
  });
}

/// Opens a page, and judges what it says in `window.report`: prints a summary, or the faults and fails. A picture of the page
/// goes to `out`. Folders are served by the first part of the path.
export async function judge({ folders, page, out, verify, summary }) {
  const { browser, url, close } = await open(folders);
  try {
    const report = await reportOf(browser, url(page), out);
    const faults = report.error ? [report.error] : verify(report);
    if (faults.length) throw new Error(faults.join('; '));
    console.log(summary(report));
  } catch (error) {
    console.error(`error: ${error.message}`);
    process.exitCode = 1;
  } finally {
    await close();
  }
}

async function open(folders) {
  const server = http.createServer((request, response) => serve(folders, request, response)).listen(0, '127.0.0.1');
  const browser = await launch(TIMEOUT_MS);
  const close = async () => {
    await browser.close();
    server.close();
  };
  return { browser, url: (rest) => `http://127.0.0.1:${server.address().port}/${rest}`, close };
}

function serve(folders, request, response) {
  const [, root, ...rest] = decodeURIComponent(new URL(request.url, 'http://localhost').pathname).split('/');
  const file = folders[root] && path.join(folders[root], ...rest);
  if (!file?.startsWith(folders[root]) || !fs.existsSync(file)) return response.writeHead(404).end();
  response.setHeader('content-type', TYPES[path.extname(file)] ?? 'application/octet-stream');
  fs.createReadStream(file).pipe(response);
}

/// Fails if the page does.
async function reportOf(browser, address, out) {
  const page = await browser.newPage();
  const failure = new Promise((_, reject) => page.on('pageerror', reject));
  await page.setViewport({ width: WIDTH, height: HEIGHT });
  const loaded = page.goto(address).then(() => page.waitForFunction('window.report', { timeout: TIMEOUT_MS }));
  await Promise.race([loaded, failure]);
  const report = await page.evaluate('window.report');
  await page.screenshot({ path: out });
  return report;
}

/// What is wrong with a picture of the inside of a cave.
export function faultsOfPicture({ mean, deviation, background }) {
  const faults = [];
  if (mean < 0.02) faults.push(`the picture is dark (mean ${mean.toFixed(4)})`);
  if (deviation < 0.01) faults.push(`the picture is flat (deviation ${deviation.toFixed(4)})`);
  if (background > 0.01) faults.push(`${(100 * background).toFixed(1)} % of the view is not rock`);
  return faults;
}
