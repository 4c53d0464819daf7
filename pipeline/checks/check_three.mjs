// Loads GLB files with the loader of three.js; every file must have a scene, and every object a piece and known materials.
//   npm install three && node check_three.mjs out/*.glb
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

// The package is looked for from the working folder, where `npm install` put it.
const installed = createRequire(join(process.cwd(), "_")).resolve("three/addons/loaders/GLTFLoader.js");
const { GLTFLoader } = await import(pathToFileURL(installed));

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node check_three.mjs FILE.glb ...");
  process.exit(2);
}

// Problems of a loaded scene.
function problems(scene) {
  if (!scene) return ["no scene"];
  const found = [];
  for (const object of scene.children) {
    if (object.type === "Object3D") continue; // The node of a file with nothing in it.
    if (!Number.isInteger(object.userData.piece)) found.push(`${object.name} has no piece`);
    object.traverse((part) => {
      if (!part.geometry) return;
      const { position, normal, uv, _velocity, _crack } = part.geometry.attributes;
      if (!position || _velocity?.itemSize !== 3) found.push(`${object.name} lacks positions or velocities`);
      const isWall = part.material.name === "inside";
      if (_crack && (_crack.itemSize !== 3 || !isWall)) found.push(`${object.name} tells of cracks otherwise`);
      if (part.isPoints) return;
      if (!normal || !uv) found.push(`${object.name} lacks normals or texture coordinates`);
      if (!["outside", "inside"].includes(part.material.name)) found.push(`${object.name} has ${part.material.name}`);
    });
  }
  return found;
}

let bad = 0;
for (const file of files) {
  let found;
  try {
    const { buffer, byteOffset, byteLength } = await readFile(file);
    found = problems((await new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), "")).scene);
  } catch (problem) {
    found = [problem];
  }
  for (const problem of found) console.error(`${file}: ${problem}`);
  bad += found.length > 0 ? 1 : 0;
}
console.log(`${files.length} GLB files in three.js: ${bad} bad`);
process.exit(bad > 0 ? 1 : 0);
