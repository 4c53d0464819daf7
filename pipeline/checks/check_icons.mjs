// Loads real icons as bodies, cracks some of them, and holds the solids against pictures of the icons.
//
//     npm install @fortawesome/fontawesome-free bootstrap-icons simple-icons @resvg/resvg-js
//     pip install meshio trimesh numpy networkx scipy
//     node check_icons.mjs FISSURE [LOAD [CRACK [SEED]]]
//
// FISSURE is the program. LOAD icons (1000), drawn at random from the three packages by SEED (1), are loaded whole, as
// one body each: at least 99 % must load. CRACK of these (60) are cracked by a line through their longest row of pixels,
// every other one all the way through, and run: the GLB and the PLY must be watertight (check_solids.py) and their area
// within 0.5 % of what resvg paints. Run it from the folder with node_modules; python is taken from venv/ there if any.

import { execFile } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { promisify } from "node:util";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const run = promisify(execFile);
const modules = resolve("node_modules");
const { Resvg } = createRequire(join(modules, "x.js"))("@resvg/resvg-js");

const SVG_FOLDERS = ["@fortawesome/fontawesome-free/svgs", "bootstrap-icons/icons", "simple-icons/icons"];
const PIXELS = 1600;
const LOADED_SHARE = 0.99;
const AREA_TOLERANCE = 0.005;

const [program, loadCount = "1000", crackCount = "60", seed = "1"] = process.argv.slice(2);
if (!program) {
    console.error("usage: node check_icons.mjs FISSURE [LOAD [CRACK [SEED]]]");
    process.exit(2);
}
const fissure = resolve(program);
const folder = mkdtempSync(join(tmpdir(), "fissure-icons-"));

/** All drawings of the packages, in an order that depends on the seed alone. */
function shuffledIcons() {
    const files = SVG_FOLDERS.flatMap((path) =>
        readdirSync(join(modules, path), { recursive: true }).filter((name) => name.endsWith(".svg")).sort()
            .map((name) => join(modules, path, name)));
    let state = BigInt(seed);
    const random = (below) => {
        state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
        return Number((state >> 33n) % BigInt(below));
    };
    for (let i = files.length - 1; i > 0; i--) {
        const j = random(i + 1);
        [files[i], files[j]] = [files[j], files[i]];
    }
    return files;
}

/** The viewBox of an icon: all three packages write one. */
function viewBox(svg) {
    return svg.match(/viewBox="([^"]*)"/)[1].trim().split(/[\s,]+/).map(Number);
}

/** How much of each pixel resvg paints, with half the page around it, since icons may stick out. */
function painted(svg) {
    const [x, y, w, h] = viewBox(svg);
    const wide = svg
        .replace(/<svg[^>]*>/, (tag) => tag.replace(/\s(width|height)="[^"]*"/g, ""))
        .replace(/viewBox="[^"]*"/, `viewBox="${x - w / 2} ${y - h / 2} ${2 * w} ${2 * h}"`);
    const image = new Resvg(wide, { fitTo: { mode: "width", value: PIXELS } }).render();
    // Every look at image.pixels copies all of them, and one at image.width asks the library.
    const { width, height, pixels } = image;
    const opacity = (column, row) => pixels[4 * (row * width + column) + 3] / 255;
    return { width, height, opacity, unit: (2 * w) / width };
}

/** Area that is painted, in the units of the drawing. */
function paintedArea(picture) {
    let area = 0;
    for (let row = 0; row < picture.height; row++) {
        for (let column = 0; column < picture.width; column++) area += picture.opacity(column, row);
    }
    return area * picture.unit ** 2;
}

/** The longest row of painted pixels, in the frame of the scene: y up, (0, 0) in the middle. */
function longestRow(picture) {
    let best = { length: 0 };
    for (let row = 0; row < picture.height; row += 3) {
        let length = 0;
        for (let column = 0; column < picture.width; column++) {
            length = picture.opacity(column, row) > 0.99 ? length + 1 : 0;
            if (length > best.length) best = { length, row, end: column + 1 };
        }
    }
    const x = (column) => (column - picture.width / 2) * picture.unit;
    return { y: (picture.height / 2 - best.row - 0.5) * picture.unit, from: x(best.end - best.length), to: x(best.end) };
}

/** A scene with the whole drawing as its body, one unit a metre. */
function scene(file, rest) {
    const path = join(folder, `${file.replaceAll(/[^a-z0-9]+/gi, "-").slice(-60)}.toml`);
    writeFileSync(path, `[drawing]
file = ${JSON.stringify(file)}
metres_per_unit = 1

[[body]]
name = "icon"
material = "pmma"
shape = { svg = "*" }
${rest}`);
    return path;
}

async function load(file) {
    try {
        await run(fissure, ["check", scene(file, "")]);
        return null;
    } catch (failure) {
        return `${file}: ${(failure.stderr || String(failure)).trim().split("\n").slice(0, 3).join(" ")}`;
    }
}

/** Cracks an icon; returns the manifest of its meshes, the drawn area and the problem if there is one. */
async function crack(file, index) {
    const svg = readFileSync(file, "utf8");
    const picture = painted(svg);
    const area = paintedArea(picture);
    const { y, from, to } = longestRow(picture);
    const end = index % 2 === 0 ? to + 2 * picture.unit : from + 0.6 * (to - from);
    const path = scene(file, `
[[crack]]
body = "icon"
line = [[${from - 2 * picture.unit}, ${y}], [${end}, ${y}]]

[frames]
range = "1-2"
rate = 1e5

[output]
thickness = ${0.05 * viewBox(svg)[2]}
formats = ["glb", "ply"]
`);
    const output = join(folder, `out-${index}`);
    try {
        await run(fissure, ["run", path, "--quiet", "--output", output]);
    } catch (failure) {
        return { problem: `${file}: ${(failure.stderr || String(failure)).trim().split("\n").slice(0, 3).join(" ")}` };
    }
    const manifest = join(output, "manifest.json");
    const solids = JSON.parse(readFileSync(manifest, "utf8")).files.filter((record) => record.part === "cracked");
    const off = Math.max(...solids.map((record) => Math.abs(record.area / area - 1)));
    const problem = solids.length > 0 && off <= AREA_TOLERANCE ? null : `${file}: the area is off by ${100 * off} %`;
    return { manifest, problem, off };
}

/** Applies `work` to all items, two at a time, in order. */
async function all(items, work) {
    const results = [];
    let next = 0;
    const worker = async () => {
        while (next < items.length) {
            const index = next++;
            results[index] = await work(items[index], index);
        }
    };
    await Promise.all([worker(), worker()]);
    return results;
}

const icons = shuffledIcons().slice(0, Number(loadCount));
const refusals = (await all(icons, load)).filter(Boolean);
refusals.forEach((refusal) => console.error(refusal));
console.log(`${icons.length - refusals.length} of ${icons.length} icons load`);

// What is half transparent is drawn in full: its pixels do not tell its area.
const opaque = icons.filter((file) => !/opacity/.test(readFileSync(file, "utf8"))).slice(0, Number(crackCount));
const cracked = await all(opaque, crack);
const problems = cracked.map((result) => result.problem).filter(Boolean);
problems.forEach((problem) => console.error(problem));
const worst = Math.max(...cracked.map((result) => result.off ?? 0));
console.log(`${cracked.length - problems.length} of ${cracked.length} cracked icons have the drawn area, off by at most ${(100 * worst).toFixed(3)} %`);

const manifests = cracked.map((result) => result.manifest).filter(Boolean);
const python = existsSync("venv/bin/python") ? "venv/bin/python" : "python3";
const solids = join(dirname(fileURLToPath(import.meta.url)), "check_solids.py");
const watertight = await run(python, [solids, ...manifests], { maxBuffer: 1 << 26 }).catch((failure) => failure);
process.stdout.write(watertight.stdout ?? "");
process.stderr.write(watertight.stderr ?? "");

const fine = refusals.length <= (1 - LOADED_SHARE) * icons.length && problems.length === 0 && !watertight.code;
if (fine) {
    rmSync(folder, { recursive: true });
} else {
    console.error(`what was made is in ${folder}`);
}
process.exit(fine ? 0 : 1);
