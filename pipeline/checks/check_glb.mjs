// Validates GLB files with Khronos' glTF-Validator; any error or warning fails.
//   npm install gltf-validator && node check_glb.mjs out/*.glb
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

// The package is looked for from the working folder, where `npm install` put it.
const validator = createRequire(join(process.cwd(), "_"))("gltf-validator");

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node check_glb.mjs FILE.glb ...");
  process.exit(2);
}

const totals = { errors: 0, warnings: 0, infos: 0, hints: 0 };
for (const file of files) {
  let issues;
  try {
    ({ issues } = await validator.validateBytes(new Uint8Array(await readFile(file)), { maxIssues: 20 }));
  } catch (problem) {
    console.error(`${file}: ${problem}`);
    totals.errors += 1;
    continue;
  }
  totals.errors += issues.numErrors;
  totals.warnings += issues.numWarnings;
  totals.infos += issues.numInfos;
  totals.hints += issues.numHints;
  for (const { severity, code, message, pointer } of issues.messages) {
    // 0 error, 1 warning, 2 information, 3 hint
    if (severity < 2) console.error(`${file}: ${code} at ${pointer}: ${message}`);
  }
}
const { errors, warnings, infos, hints } = totals;
console.log(`${files.length} GLB files: ${errors} errors, ${warnings} warnings, ${infos} infos, ${hints} hints`);
process.exit(errors + warnings > 0 ? 1 : 0);
