// Opens the page that `plume preview` writes in headless Chromium, turns the cave about and cuts it open.
//
//   node page.mjs FOLDER
//
// Takes the one HTML file of the folder, and leaves a picture of it beside it. Fails if the page says an error, asks for
// anything but itself, shows nothing, or shows the same whatever is done to it.
import fs from 'node:fs';
import path from 'node:path';
import { launch } from './browser.mjs';

const WIDTH = 1280;
const HEIGHT = 800;
const TIMEOUT_MS = 120_000;
const DEED_TIMEOUT_MS = 15_000;
// Of the pixels of the view: how many must differ from the paper, and from before after each deed.
const LEAST_DRAWN = 0.01;
const LEAST_CHANGED = 0.03;

const [folder] = process.argv.slice(2);
if (!folder) throw new Error('usage: page.mjs FOLDER');
const name = fs.readdirSync(folder).find((file) => file.endsWith('.html'));
const file = path.resolve(folder, name);

const browser = await launch(TIMEOUT_MS);
try {
  const faults = [];
  const page = await browser.newPage();
  page.on('pageerror', (error) => faults.push(`the page failed: ${error.message}`));
  page.on('console', (line) => ['error', 'warning'].includes(line.type()) && faults.push(`the console says: ${line.text()}`));
  page.on('request', (request) => request.url() !== `file://${file}` && faults.push(`it asks for ${request.url()}`));
  await page.setViewport({ width: WIDTH, height: HEIGHT });
  await page.goto(`file://${file}`);
  const shown = [await look(page, 0)];
  const drawn = different(shown[0], shown[0].slice(0, 3));
  if (drawn < LEAST_DRAWN) faults.push(`only ${(100 * drawn).toFixed(2)} % of the view is drawn`);
  await page.screenshot({ path: file.replace(/html$/, 'png') });
  for (const [deed, act] of Object.entries(DEEDS())) {
    const before = await count(page);
    await act(page);
    const seen = await look(page, before, DEED_TIMEOUT_MS).catch(() => null);
    if (!seen) {
      faults.push(`${deed} draws nothing`);
      continue;
    }
    shown.push(seen);
    const changed = different(shown.at(-1), shown.at(-2));
    if (changed < LEAST_CHANGED) faults.push(`${deed} changes ${(100 * changed).toFixed(2)} % of the view`);
  }
  if (faults.length) throw new Error(faults.join('; '));
  console.log(`Chromium: ${(100 * drawn).toFixed(1)} % of the view drawn, turned, zoomed, cut and wired without a word`);
} catch (error) {
  console.error(`error: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
}

function DEEDS() {
  const click = (id) => (page) => page.click(`#${id}`);
  return {
    turning: async (page) => {
      await page.mouse.move(700, 400);
      await page.mouse.down();
      await page.mouse.move(850, 460, { steps: 3 });
      await page.mouse.up();
    },
    zooming: (page) => page.mouse.wheel({ deltaY: -400 }),
    'drawing triangles': click('wires'),
    'switching passages': click('tubes'),
    'cutting it open': (page) => page.evaluate(() => {
      const slice = document.getElementById('slice');
      slice.value = 500;
      slice.dispatchEvent(new Event('input'));
    }),
  };
}

function count(page) {
  return page.evaluate(() => Number(document.body.dataset.drawn || 0));
}

// The pixels of the view, once it was drawn again.
async function look(page, before, timeout = TIMEOUT_MS) {
  await page.waitForFunction((seen) => Number(document.body.dataset.drawn || 0) > seen, { timeout }, before);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const pixels = await page.evaluate(() => {
    const view = document.getElementById('view');
    const copy = Object.assign(document.createElement('canvas'), { width: 320, height: 200 });
    const paper = copy.getContext('2d', { willReadFrequently: true });
    paper.drawImage(view, 0, 0, 320, 200);
    return Array.from(paper.getImageData(0, 0, 320, 200).data).filter((_, i) => i % 4 < 3);
  });
  return pixels;
}

// The share of pixels that differ visibly from those of another view, or from one colour.
function different(view, other) {
  let count = 0;
  for (let i = 0; i < view.length; i += 3) {
    const apart = [0, 1, 2].map((c) => Math.abs(view[i + c] - other[(i + c) % other.length]));
    if (Math.max(...apart) > 12) count += 1;
  }
  return count / (view.length / 3);
}
