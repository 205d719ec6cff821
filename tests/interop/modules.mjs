// Finds npm packages in the folder that INTEROP names (`cargo xtask` sets it), else beside the scripts or the caller.
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));

/** A `require` that can load `name`. */
export function requireFor(name) {
  for (const folder of [process.env.INTEROP, process.cwd(), here].filter(Boolean)) {
    const require = createRequire(path.resolve(folder) + '/');
    try {
      require.resolve(name);
      return require;
    } catch { /* not in this folder */ }
  }
  console.error(`${name} is not installed: run \`cargo xtask setup\``);
  process.exit(2);
}
