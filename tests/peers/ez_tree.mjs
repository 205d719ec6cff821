#!/usr/bin/env node
// The peer of our trees: times ez-tree (npm @dgreenheck/ez-tree) making trees on one core, geometry only.
//   node ez_tree.mjs [TREES [TRIANGLES]]
// Takes the four of its presets that come nearest to TRIANGLES (18000) in turn, and of three rounds the fastest.
// Prints three numbers: trees, milliseconds for all of them, mean triangles.
import { requireFor } from '../interop/modules.mjs';
import { pathToFileURL } from 'node:url';

// The library loads its textures when it starts; it needs as much of a page as an image has.
const image = () => ({ addEventListener() {}, removeEventListener() {}, set src(_) {}, get src() { return ''; } });
globalThis.document = { createElementNS: image, createElement: image };
globalThis.self = globalThis;

const name = '@dgreenheck/ez-tree';
const entry = requireFor(name).resolve(name).replace(/umd\.js$/, 'es.js');
const { Tree, TreePreset } = await import(pathToFileURL(entry));

const trees = Number(process.argv[2] ?? 20);
const wanted = Number(process.argv[3] ?? 18000);

function generate(preset, seed) {
  const tree = new Tree();
  tree.options.copy(TreePreset[preset]);
  tree.options.seed = seed;
  const start = performance.now();
  tree.generate();
  const ms = performance.now() - start;
  return { ms, triangles: (tree.branches.indices.length + tree.leaves.indices.length) / 3 };
}

// Twice each first, so that the compiler has seen all of it: the peer at its best.
const sizes = Object.keys(TreePreset).map(preset => {
  generate(preset, 1);
  return { preset, triangles: generate(preset, 2).triangles };
});
const nearest = sizes
  .filter(size => size.triangles > 0)
  .sort((a, b) => Math.abs(Math.log(a.triangles / wanted)) - Math.abs(Math.log(b.triangles / wanted)))
  .slice(0, 4);

let best;
for (let round = 0; round < 3; round++) {
  const made = Array.from({ length: trees }, (_, i) => generate(nearest[i % nearest.length].preset, 100 + i));
  const ms = made.reduce((sum, tree) => sum + tree.ms, 0);
  const triangles = made.reduce((sum, tree) => sum + tree.triangles, 0) / trees;
  if (!best || ms < best.ms) best = { ms, triangles };
}
console.log(trees, best.ms.toFixed(1), best.triangles.toFixed(0));
