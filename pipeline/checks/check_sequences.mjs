// Plays the GLB files of whole sequences with three.js and holds every frame against the GLB file of that frame.
//   npm install three && node check_sequences.mjs FOLDER
// FOLDER holds the files of `fissure post TAKE --formats glb,glb_sequence,glb_rigid --output FOLDER`. In each frame the
// objects that are seen, by name and number, are those of its own file; of a sequence their vertices are the same to the
// bit, of a file with rigid motion their boxes are the same within the thousandth of their size that is promised.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

// The package is looked for from the working folder, where `npm install` put it.
const require = createRequire(join(process.cwd(), "_"));
const loader = pathToFileURL(require.resolve("three/addons/loaders/GLTFLoader.js"));
const { GLTFLoader } = await import(loader);
// The module that the loader itself takes.
const { AnimationMixer, Box3, Vector3 } = await import(new URL("../../../build/three.module.js", loader));

// A thousandth of the size of the fragment when its mesh was made; here it is compared with that of this frame.
const TOLERANCE = 1.25e-3;

const [folder] = process.argv.slice(2);
if (!folder) {
  console.error("usage: node check_sequences.mjs FOLDER");
  process.exit(2);
}

async function load(file) {
  const { buffer, byteOffset, byteLength } = await readFile(join(folder, file));
  return new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), "");
}

// Vertices in the world of all objects that are seen, by piece.
function seen(scene) {
  scene.updateMatrixWorld(true);
  const pieces = new Map();
  scene.traverse((part) => {
    if (!part.geometry || part.matrixWorld.determinant() === 0) return;
    let owner = part;
    while (owner.userData.piece === undefined) owner = owner.parent;
    const position = part.geometry.attributes.position;
    if (!pieces.has(owner.userData.piece)) pieces.set(owner.userData.piece, []);
    const vertices = pieces.get(owner.userData.piece);
    for (let i = 0; i < position.count; i++) {
      vertices.push(new Vector3().fromBufferAttribute(position, i).applyMatrix4(part.matrixWorld));
    }
  });
  return pieces;
}

function problem(expected, found, isRigid) {
  if (found.size !== expected.size) return `${found.size} objects instead of ${expected.size}`;
  for (const [piece, vertices] of expected) {
    const others = found.get(piece);
    if (!others) return `no piece ${piece}`;
    if (!isRigid) {
      if (others.length !== vertices.length || others.some((v, i) => !v.equals(vertices[i]))) return `piece ${piece} differs`;
      continue;
    }
    const [box, other] = [vertices, others].map((points) => new Box3().setFromPoints(points));
    const size = box.getSize(new Vector3());
    const off = Math.max(...[box.min.clone().sub(other.min), box.max.clone().sub(other.max)].flatMap((d) => [Math.abs(d.x), Math.abs(d.y)])) / Math.max(size.x, size.y);
    worst = Math.max(worst, off);
    if (off > TOLERANCE) return `piece ${piece} is off by ${off} of its size`;
  }
  return null;
}

let [bad, frames, worst] = [0, 0, 0];
const manifest = JSON.parse(await readFile(join(folder, "manifest.json")));
for (const sequence of manifest.sequences.filter((record) => record.format.startsWith("glb"))) {
  const { scene, animations } = await load(sequence.file);
  const { first, playback } = JSON.parse((await readFile(join(folder, sequence.file))).toString("latin1").match(/"extras":(\{"tool".*?\})/)[1]);
  const mixer = new AnimationMixer(scene);
  animations.forEach((clip) => mixer.clipAction(clip).play());
  for (const record of manifest.files.filter((one) => one.part === sequence.part && one.format === "glb")) {
    // Just after the frame begins: times are rounded to single precision.
    mixer.setTime((record.frame - first + 1e-4) / playback);
    const told = problem(seen((await load(record.file)).scene), seen(scene), sequence.format === "glb_rigid");
    if (told) console.error(`${sequence.file}: frame ${record.frame}: ${told}`);
    bad += told ? 1 : 0;
    frames += 1;
  }
}
console.log(`${frames} frames of sequences in three.js: ${bad} bad, rigid motion within ${worst.toExponential(1)} of the size`);
process.exit(bad > 0 || frames === 0 ? 1 : 0);
