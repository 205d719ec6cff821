#!/usr/bin/env node
// Our viewer beside three.js (in Chromium, its OpenGL by Mesa's llvmpipe): the same scene.gltf, camera path, size and
// processors, frame by frame in turn.
//   node three_viewer.mjs SCENE.gltf [--viewer PROGRAM] [--size 800x600] [--steps 4] [--pictures FOLDER] [--json]
// Each place is drawn twice, on the way there and back, and the cheaper counts. Times are milliseconds of the clock and
// of processors: all threads of `viewer bench --serve`, all processes of Chromium. Exit 1 if an aim is missed, 2 if a
// program is missing or Chromium does not draw with llvmpipe (then nothing can be compared).
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import readline from 'node:readline';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { requireFor } from '../interop/modules.mjs';

const here = path.dirname(fileURLToPath(import.meta.url));
const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    viewer: { type: 'string', default: path.join(here, '../../target/release/viewer') },
    chromium: { type: 'string', default: process.env.CHROMIUM },
    size: { type: 'string', default: '800x600' },
    steps: { type: 'string', default: '4' },
    pictures: { type: 'string' },
    json: { type: 'boolean', default: false },
  },
});
const [scene] = positionals;
if (!scene) fail('usage: three_viewer.mjs SCENE.gltf [--viewer PROGRAM] [--size WxH] [--steps N] [--pictures FOLDER]');

function fail(text) {
  console.error(text);
  process.exit(2);
}

/** The first Chromium there is. */
function chromium() {
  const folders = (process.env.PATH ?? '').split(path.delimiter);
  const names = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable'];
  const all = names.flatMap(name => folders.map(folder => path.join(folder, name)));
  return options.chromium ?? all.find(file => fs.existsSync(file)) ?? fail('Chromium is not installed (Debian: chromium)');
}

// ── Ours ──────────────────────────────────────────────────────────────────────────────────────────────────────────────

/** `viewer bench --serve`: asks for a line, waits for a line. */
async function startOurs() {
  const program = spawn(options.viewer, ['bench', '--serve', '--size', options.size, '--steps', options.steps, scene],
    { stdio: ['pipe', 'pipe', 'inherit'] });
  program.on('error', error => fail(`${options.viewer} cannot be started (${error.message}): cargo build --release -p genescape-viewer`));
  const lines = readline.createInterface({ input: program.stdout })[Symbol.asyncIterator]();
  const next = async () => {
    const { value, done } = await lines.next();
    return done ? fail('viewer bench --serve ended') : JSON.parse(value);
  };
  return {
    told: await next(),
    frame: async (way, place) => { program.stdin.write(`frame ${way} ${place}\n`); return next(); },
    picture: async (way, place, file) => { program.stdin.write(`picture ${way} ${place} ${file}\n`); await next(); },
    stop: () => program.stdin.end(),
  };
}

// ── three.js ──────────────────────────────────────────────────────────────────────────────────────────────────────────

/** Serves the page, three.js and the folders above the scene; on this machine only. */
async function serve(folders) {
  const types = { '.html': 'text/html', '.js': 'text/javascript', '.gltf': 'model/gltf+json', '.png': 'image/png' };
  const server = http.createServer((request, response) => {
    const url = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    const [prefix, folder] = Object.entries(folders).find(([prefix]) => url.startsWith(prefix)) ?? [];
    const file = folder && path.join(folder, url.slice(prefix.length));
    if (!file || !file.startsWith(folder) || !fs.existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, { 'content-type': types[path.extname(file)] ?? 'application/octet-stream' });
    fs.createReadStream(file).pipe(response);
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  return server;
}

/** Nanoseconds that a process, its threads and its children's have had of processors. */
function processorTime(root) {
  const children = new Map();
  for (const pid of fs.readdirSync('/proc').filter(name => /^\d+$/.test(name))) {
    try {
      const stat = fs.readFileSync(`/proc/${pid}/stat`, 'utf8');
      const parent = stat.slice(stat.lastIndexOf(')') + 2).split(' ')[1];
      children.set(parent, [...(children.get(parent) ?? []), pid]);
    } catch { /* it has just ended */ }
  }
  let sum = 0;
  for (const todo = [String(root)]; todo.length > 0;) {
    const pid = todo.pop();
    todo.push(...(children.get(pid) ?? []));
    try {
      for (const task of fs.readdirSync(`/proc/${pid}/task`)) {
        sum += Number(fs.readFileSync(`/proc/${pid}/task/${task}/schedstat`, 'utf8').split(' ')[0]);
      }
    } catch { /* it has just ended */ }
  }
  return sum;
}

async function startThree(told) {
  const three = path.join(path.dirname(requireFor('three').resolve('three')), '..');
  // Blobs lie some folders above the scene, so the scene is served from there.
  const file = path.resolve(scene);
  const above = path.resolve(path.dirname(file), '../..');
  const server = await serve({ '/three/': three + path.sep, '/world/': above + path.sep, '/': here + path.sep });
  const origin = `http://127.0.0.1:${server.address().port}`;
  const puppeteer = requireFor('puppeteer-core')('puppeteer-core');
  const browser = await puppeteer.launch({
    executablePath: chromium(),
    // llvmpipe without a display; needs no X server.
    args: ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist', '--no-sandbox', '--disable-frame-rate-limit',
      '--disable-background-timer-throttling'],
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1', GALLIUM_DRIVER: 'llvmpipe' },
    protocolTimeout: 600_000,
  });
  const page = await browser.newPage();
  page.on('pageerror', error => console.error(`page: ${error.message}`));
  page.on('console', message => { if (message.type() === 'error') console.error(`page: ${message.text()}`); });
  await page.goto(`${origin}/three_viewer.html`);
  await page.waitForFunction('window.ready');
  const url = `${origin}/world/${path.relative(above, file).split(path.sep).join('/')}`;
  const hello = await page.evaluate((url, told) => window.peer.setup(url, told), url, told);
  const root = browser.process().pid;
  return {
    told: hello,
    frame: async (way, place) => {
      const before = processorTime(root);
      const frame = await page.evaluate((way, place) => window.peer.frame(way, place), way, told.cameras[place]);
      return { ...frame, cpu_ms: (processorTime(root) - before) / 1e6 };
    },
    picture: async (way, place, file) => {
      const url = await page.evaluate((way, place) => window.peer.picture(way, place), way, told.cameras[place]);
      fs.writeFileSync(file, Buffer.from(url.split(',')[1], 'base64'));
    },
    stop: async () => { await browser.close(); server.close(); },
  };
}

// ── Side by side ──────────────────────────────────────────────────────────────────────────────────────────────────────

const ours = await startOurs();
const three = await startThree(ours.told);
const load = () => os.loadavg()[0].toFixed(2);
const say = text => { if (!options.json) console.log(text); };
say(`ours:     ${ours.told.device}, wgpu`);
say(`three.js: r${three.told.revision}, ${three.told.device}`);
say(`${ours.told.trees} trees, ${options.size}, ${ours.told.cameras.length} places there and back, `
  + `${os.cpus().length} cores, load average ${load()}`);
if (!/llvmpipe/i.test(three.told.device) || !ours.told.software) {
  await three.stop();
  fail('the two do not draw with the same software rasteriser: nothing can be compared');
}

const OFF = 'ours, no levels of detail', TREES_OFF = 'ours, trees without levels of detail', ON = 'ours, levels of detail';
const INSTANCED = 'three.js, full trees, instanced', CULLED = 'three.js, full trees, culled', FILE = 'three.js, the file as it is';
const contestants = [
  [OFF, ours, 'off off'], [INSTANCED, three, 'instanced'], [TREES_OFF, ours, 'off morph'],
  [CULLED, three, 'culled'], [ON, ours, 'simple morph'], [FILE, three, 'file'],
].map(([name, who, way]) => ({ name, who, way, frames: [] }));

for (const { who, way } of contestants) await who.frame(way, 0);
const places = ours.told.cameras.map((_, place) => place);
for (const place of [...places, ...places.toReversed()]) {
  for (const { who, way, frames } of contestants) {
    const frame = await who.frame(way, place);
    const known = frames[place];
    frames[place] = { ...frame, wall_ms: Math.min(frame.wall_ms, known?.wall_ms ?? Infinity),
      cpu_ms: Math.min(frame.cpu_ms, known?.cpu_ms ?? Infinity) };
  }
}
if (options.pictures) {
  fs.mkdirSync(options.pictures, { recursive: true });
  const middle = Math.floor(places.length / 2);
  for (const { name, who, way } of contestants) {
    await who.picture(way, middle, path.resolve(options.pictures, `${name.replaceAll(/[^a-z.]+/g, '-')}.png`));
  }
}
ours.stop();
await three.stop();

const mean = (frames, field) => frames.reduce((sum, frame) => sum + frame[field], 0) / frames.length;
const result = Object.fromEntries(contestants.map(({ name, frames }) =>
  [name, { wall_ms: mean(frames, 'wall_ms'), cpu_ms: mean(frames, 'cpu_ms'), triangles: mean(frames, 'triangles') || null }]));
say('\n' + 'mean of a frame'.padEnd(40) + 'clock ms'.padStart(10) + 'cpu ms'.padStart(10) + 'triangles'.padStart(12));
for (const [name, { wall_ms, cpu_ms, triangles }] of Object.entries(result)) {
  say(name.padEnd(40) + wall_ms.toFixed(0).padStart(10) + cpu_ms.toFixed(0).padStart(10)
    + (triangles ? triangles.toFixed(0) : '').padStart(12));
}

// Whichever way of drawing full trees is faster for three.js is what we are compared with.
const full = field => Math.min(result[INSTANCED][field], result[CULLED][field]);
const ratios = [
  ['full trees: three.js / ours without any levels of detail', field => full(field) / result[OFF][field], 2],
  ['full trees: three.js / ours, levels of detail of the land only', field => full(field) / result[TREES_OFF][field]],
  ['three.js with full trees / ours with levels of detail', field => full(field) / result[ON][field], 6],
  ['three.js with the file as it is / ours with levels of detail', field => result[FILE].wall_ms && result[FILE][field] / result[ON][field]],
].map(([what, ratio, aim]) => ({ what, wall: ratio('wall_ms'), cpu: ratio('cpu_ms'), aim: aim ?? null }));
say('\n' + 'ratio'.padEnd(66) + 'clock'.padStart(8) + 'cpu'.padStart(8));
for (const { what, wall, cpu, aim } of ratios) {
  const verdict = aim ? `   ${cpu >= aim ? 'met' : 'MISSED'}: at least ${aim}` : '';
  say(what.padEnd(66) + wall.toFixed(2).padStart(8) + cpu.toFixed(2).padStart(8) + verdict);
}
say(`load average ${load()}`);
if (options.json) {
  console.log(JSON.stringify({ ours: ours.told.device, three: three.told, size: options.size, load: load(), result, ratios }));
}
process.exit(ratios.every(({ cpu, aim }) => !aim || cpu >= aim) ? 0 : 1);
