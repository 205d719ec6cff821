#!/usr/bin/env node
// Loads files with three.js's GLTFLoader (no GPU, images left out):  node three_check.mjs FILE…
// Prints a line of JSON for each. Exit 1 if one does not load, warns, or has a mesh with a NaN in its bounds.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { requireFor } from './modules.mjs';

const root = path.join(path.dirname(requireFor('three').resolve('three')), '..');
const load = file => import(pathToFileURL(path.join(root, file)).href);
globalThis.self = globalThis;
globalThis.createImageBitmap ??= async () => ({ width: 1, height: 1, close() {} });
globalThis.ProgressEvent ??= class { constructor(type) { this.type = type; } };
const THREE = await load('build/three.module.js');
const { GLTFLoader } = await load('examples/jsm/loaders/GLTFLoader.js');

/** The file's bytes, with buffers of a .gltf inlined since node has no fetch for files. */
function read(file) {
  const bytes = fs.readFileSync(file);
  if (file.endsWith('.glb')) return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const json = JSON.parse(bytes);
  for (const buffer of json.buffers ?? []) {
    const data = fs.readFileSync(path.join(path.dirname(file), buffer.uri));
    buffer.uri = 'data:application/octet-stream;base64,' + data.toString('base64');
  }
  return JSON.stringify(json);
}

let exit = 0;
for (const file of process.argv.slice(2)) {
  const log = [];
  for (const kind of ['warn', 'error']) console[kind] = (...words) => log.push(`${kind}: ${words.join(' ')}`);
  const result = { file, three: THREE.REVISION, meshes: 0, vertices: 0, morphed: 0, lights: 0, cameras: 0 };
  try {
    const gltf = await new GLTFLoader().parseAsync(read(file), path.resolve(path.dirname(file)) + '/');
    gltf.scene.updateMatrixWorld(true);
    result.scenes = gltf.scenes.length;
    gltf.scene.traverse(object => {
      if (object.isLight) result.lights++;
      if (object.isCamera) result.cameras++;
      if (!object.isMesh) return;
      result.meshes++;
      result.vertices += object.geometry.attributes.position.count;
      if (object.morphTargetDictionary) result.morphed++;
      object.geometry.computeBoundingSphere();
      if (!Number.isFinite(object.geometry.boundingSphere.radius)) log.push(`error: ${object.name} has no bounds`);
    });
  } catch (error) {
    log.push(`error: ${error.message ?? error}`);
  }
  // Textures cannot be decoded without a browser, so what is said of them is no news.
  result.log = log.filter(line => !/texture/i.test(line));
  result.ok = result.log.length === 0 && result.meshes > 0;
  if (!result.ok) exit = 1;
  console.log(JSON.stringify(result));
}
process.exit(exit);
