#!/usr/bin/env node
// Khronos glTF validator:  node validate.mjs [--info] FILE…
// A line for each file, then its errors and warnings (with --info, infos too).
// Exit 0: no error and no warning in any file. 1: some. 2: usage, or a file that cannot be read.
import fs from 'node:fs';
import path from 'node:path';
import { requireFor } from './modules.mjs';

const validator = requireFor('gltf-validator')('gltf-validator');
const info = process.argv.includes('--info');
const files = process.argv.slice(2).filter(argument => argument !== '--info');
if (!files.length) {
  console.error('usage: node validate.mjs [--info] FILE…');
  process.exit(2);
}
const SEVERITY = ['error', 'warning', 'info', 'hint'];
let exit = 0;
for (const file of files) {
  const folder = path.dirname(path.resolve(file));
  let report;
  try {
    report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
      uri: path.basename(file), maxIssues: 0, writeTimestamp: false,
      externalResourceFunction: async uri =>
        new Uint8Array(await fs.promises.readFile(path.join(folder, decodeURIComponent(uri)))),
    });
  } catch (error) {
    console.error(`FAIL ${file}: ${error.message ?? error}`);
    exit = 2;
    continue;
  }
  const messages = report.issues.messages;
  const count = severity => messages.filter(message => message.severity === severity).length;
  const bad = count(0) + count(1) > 0;
  if (bad && exit === 0) exit = 1;
  console.log(`${bad ? 'FAIL' : 'ok  '} ${file}: ${count(0)} errors, ${count(1)} warnings, ${count(2)} infos`);
  const groups = new Map();
  for (const message of messages.filter(m => m.severity <= 1 || info)) {
    const key = `${SEVERITY[message.severity]} ${message.code}`;
    groups.set(key, [...(groups.get(key) ?? []), message]);
  }
  for (const [key, [first, ...rest]] of groups) {
    console.log(`     ${key} ×${rest.length + 1}: ${first.message} ${first.pointer ?? `offset ${first.offset}`}`);
  }
}
process.exit(exit);
