"use strict";
const facts = JSON.parse(document.getElementById("facts").textContent);
const packed = JSON.parse(document.getElementById("meshes").textContent);
const element = (id) => document.getElementById(id);
document.documentElement.classList.toggle("dark", facts.dark);

// Frames: unpacked when they are first seen. The layout is that of packed_frame.rs.

const unpacked = new Map();

async function objectsOf(index) {
  if (!unpacked.has(index)) unpacked.set(index, unpack(packed[index]));
  return unpacked.get(index);
}

async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return objects(await new Response(stream).arrayBuffer());
}

function objects(buffer) {
  let at = 0;
  const take = (Type, count) => {
    const values = new Type(buffer, at, count);
    at += Math.ceil(count * Type.BYTES_PER_ELEMENT / 4) * 4;
    return values;
  };
  const [count] = take(Uint32Array, 1);
  return Array.from({ length: count }, () => {
    const [kind, number, length] = take(Uint32Array, 3);
    const name = new TextDecoder().decode(take(Uint8Array, length));
    const low = take(Float32Array, 3), step = take(Float32Array, 3);
    const [vertices, outside, inside] = take(Uint32Array, 3);
    const position = new Float32Array(3 * vertices), normal = new Int8Array(3 * vertices);
    const steps = take(Uint16Array, 3 * vertices);
    for (let axis = 0; axis < 3; axis++) {
      for (let i = 0, sum = 0; i < vertices; i++) {
        sum = (sum + steps[axis * vertices + i]) & 0xffff;
        position[3 * i + axis] = low[axis] + step[axis] * sum;
      }
    }
    const normals = take(Int8Array, 3 * vertices);
    for (let axis = 0; axis < 3; axis++) {
      for (let i = 0; i < vertices; i++) normal[3 * i + axis] = normals[axis * vertices + i];
    }
    const index = take(Uint32Array, 3 * (outside + inside)).slice();
    for (let i = 1; i < index.length; i++) index[i] = (index[i] + index[i - 1]) >>> 0;
    const middle = low.map((value, axis) => value + 0.5 * 65535 * step[axis]);
    const size = step.map((value) => 65535 * value);
    return { kind, number, name, position, normal, index, outside: 3 * outside, inside: 3 * inside, middle, size };
  });
}

// The scene.

const colors = facts.dark
  ? { paper: 0x181a1e, body: 0x8090a2, wall: 0xed6b30, collider: 0x5c5e64, saturation: 0.35, lightness: 0.6 }
  : { paper: 0xffffff, body: 0xbecddc, wall: 0xed6b30, collider: 0x9e9e9e, saturation: 0.45, lightness: 0.76 };
const renderer = new THREE.WebGLRenderer({ canvas: element("view"), antialias: true, preserveDrawingBuffer: true });
renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
const scene = new THREE.Scene();
scene.background = new THREE.Color(colors.paper);
const camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
const controls = new THREE.OrbitControls(camera, renderer.domElement);
controls.addEventListener("change", () => { wanted = true; });
scene.add(new THREE.HemisphereLight(0xffffff, 0xb0b4bc, 2.2));
const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
lamp.position.set(-0.3, 0.5, 1);
camera.add(lamp);
scene.add(camera);
const group = new THREE.Group();
scene.add(group);
const materials = new Map();
const plain = (color) => new THREE.MeshStandardMaterial({ color, roughness: 0.8, side: THREE.DoubleSide });
const wall = plain(colors.wall), collider = plain(colors.collider);

/** Material of the outside of a fragment; numbers that follow on each other differ by the golden angle. */
function outsideOf(number) {
  const key = element("color").value === "wall" ? 0 : number;
  if (!materials.has(key)) {
    const material = plain(colors.body);
    const golden = 0.5 * (3 - Math.sqrt(5));
    if (key > 0) material.color.setHSL((key * golden + 0.05) % 1, colors.saturation, colors.lightness, "srgb");
    materials.set(key, material);
  }
  return materials.get(key);
}

const state = { frame: 0, playing: false, explode: 0 };
let wanted = true, center = null, radius = 1, shown = -1;

/** Shows the frame of the state; the newest call wins. */
async function show() {
  const index = state.frame;
  const parts = await objectsOf(index);
  if (index !== state.frame) return;
  group.children.forEach((mesh) => mesh.geometry.dispose());
  group.clear();
  for (const part of parts) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(part.position, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(part.normal, 3, true));
    geometry.setIndex(new THREE.BufferAttribute(part.index, 1));
    geometry.addGroup(0, part.outside, 0);
    geometry.addGroup(part.outside, part.inside, 1);
    const outside = part.kind === 1 ? collider : outsideOf(part.number);
    const mesh = new THREE.Mesh(geometry, [outside, part.kind === 1 ? collider : wall]);
    mesh.name = part.name;
    mesh.userData = part;
    group.add(mesh);
  }
  shown = index;
  const facts_of = facts.frames[index];
  const fragments = parts.filter((part) => part.kind === 0).length;
  element("moment").textContent = `frame ${facts_of.number} · ${quantity(facts_of.time, "s")} · ` +
    `${fragments} ${fragments === 1 ? "fragment" : "fragments"} · ${facts_of.triangles} triangles`;
  element("timeline").value = index;
  arrange();
  plots.forEach((plot) => plot.draw());
}

/** Places and looks of the objects as the controls say. */
function arrange() {
  const outside = element("outside").checked, inside = element("inside").checked;
  for (const mesh of group.children) {
    const part = mesh.userData;
    if (part.kind === 0 && center) {
      mesh.position.set(...[0, 1, 2].map((axis) => state.explode * (part.middle[axis] - center[axis])));
    }
    mesh.visible = part.kind === 0 || element("colliders").checked;
  }
  materials.forEach((material) => { material.visible = outside; material.wireframe = element("edges").checked; });
  wall.visible = inside;
  wall.wireframe = element("edges").checked;
  wanted = true;
}

/** Looks at all fragments of the first and the last frame, from the front or a little from the side. */
async function look(yaw, pitch) {
  const ends = [await objectsOf(0), await objectsOf(packed.length - 1)].flat().filter((part) => part.kind === 0);
  if (ends.length === 0) return;
  const corner = (sign) => [0, 1, 2].map((axis) =>
    sign * Math.max(...ends.map((part) => sign * part.middle[axis] + 0.5 * part.size[axis])));
  const low = corner(-1), high = corner(1);
  center = low.map((value, axis) => 0.5 * (value + high[axis]));
  radius = 0.5 * Math.hypot(...low.map((value, axis) => high[axis] - value)) || 1;
  const distance = radius / Math.sin(camera.fov * Math.PI / 360) / Math.min(1, camera.aspect);
  const toward = [-Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)];
  camera.position.set(...center.map((value, axis) => value + 1.02 * distance * toward[axis]));
  camera.near = distance / 100;
  camera.far = distance * 20;
  camera.updateProjectionMatrix();
  controls.target.set(...center);
  controls.update();
}

// Curves.

const palette = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#8c564b", "#e377c2"];

function quantity(value, unit) {
  if (!value) return `0 ${unit}`;
  const prefixes = { "-4": "p", "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T" };
  const power = Math.max(-4, Math.min(4, Math.floor(Math.log10(Math.abs(value) * 1.0000001) / 3)));
  return `${Number((value / 1000 ** power).toPrecision(3))} ${prefixes[power]}${unit}`;
}

/** A plot of curves { name, color, x, y, time } over `across`, the unit of x. Over time a line shows the frame, and a click
 * goes there; over anything else a dot on each curve does. */
function plot(title, unit, curves, across = "s") {
  const figure = document.createElement("figure"), caption = document.createElement("figcaption");
  const canvas = document.createElement("canvas");
  figure.append(canvas, caption);
  element("plots").append(figure);
  caption.append(Object.assign(document.createElement("b"), { textContent: title }));
  curves.filter((curve) => curve.name).forEach((curve) => {
    const label = Object.assign(document.createElement("i"), { textContent: curve.name });
    label.style.color = curve.color;
    caption.append(label);
  });
  const least = (values, from) => values.reduce((a, b) => Math.min(a, b), from);
  const most = (values, from) => values.reduce((a, b) => Math.max(a, b), from);
  const isOverTime = across === "s";
  const along = isOverTime ? facts.series.energies.time : curves.flatMap((curve) => curve.x);
  const first = least(along, along[0]), span = most(along, along[0]) - first || 1;
  const values = curves.flatMap((curve) => curve.y);
  const low = least(values, 0), high = most(values, 0), height_of = high - low || 1;
  const margin = { left: 6, right: 6, top: 16, bottom: isOverTime ? 6 : 16 };
  const draw = () => {
    const scale = window.devicePixelRatio, width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * scale;
    canvas.height = height * scale;
    const paper = canvas.getContext("2d");
    paper.scale(scale, scale);
    const style = getComputedStyle(document.documentElement);
    const faint = style.getPropertyValue("--faint");
    const x = (value) => margin.left + (value - first) / span * (width - margin.left - margin.right);
    const y = (value) => height - margin.bottom - (value - low) / height_of * (height - margin.top - margin.bottom);
    const line = (points, color, thickness) => {
      paper.beginPath();
      points.forEach(([px, py], i) => (i ? paper.lineTo(px, py) : paper.moveTo(px, py)));
      paper.strokeStyle = color;
      paper.lineWidth = thickness;
      paper.stroke();
    };
    line([[margin.left, y(0)], [width - margin.right, y(0)]], style.getPropertyValue("--line"), 1);
    const now = facts.frames[state.frame].time;
    if (isOverTime) line([[x(now), margin.top], [x(now), height - margin.bottom]], faint, 1);
    for (const curve of curves) {
      line(curve.x.map((value, i) => [x(value), y(curve.y[i])]), curve.color, curve.thickness || 1.5);
      const at = curve.time ? curve.time.findLastIndex((time) => time <= now) : -1;
      if (at < 0) continue;
      paper.beginPath();
      paper.arc(x(curve.x[at]), y(curve.y[at]), 3, 0, 2 * Math.PI);
      paper.fillStyle = curve.color;
      paper.fill();
    }
    paper.fillStyle = faint;
    paper.font = "11px system-ui, sans-serif";
    paper.fillText(quantity(high > 0 ? high : low, unit), margin.left, 11);
    if (!isOverTime) {
      paper.fillText(quantity(first, across), margin.left, height - 4);
      paper.textAlign = "right";
      paper.fillText(quantity(first + span, across), width - margin.right, height - 4);
      paper.textAlign = "left";
    }
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!isOverTime) return;
    const part = (event.offsetX - margin.left) / (canvas.clientWidth - margin.left - margin.right);
    const time = first + Math.max(0, Math.min(1, part)) * span;
    const distances = facts.frames.map((frame) => Math.abs(frame.time - time));
    go(distances.indexOf(Math.min(...distances)));
  });
  return { draw };
}

/** The plots there is something to show in; of many tips the eight with the largest K have names. */
function allPlots() {
  const { tips, energies, supports } = facts.series;
  const most = (tip) => tip.mode_1.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
  const ranked = [...tips].sort((a, b) => most(b) - most(a));
  const of = (key, across) => ranked.map((tip, i) => ({
    name: i < palette.length ? tip.name : "", color: i < palette.length ? palette[i] : "#8a93a055",
    x: tip[across], y: tip[key], time: across === "time" ? undefined : tip.time,
  }));
  const unnamed = (curves) => curves.map((curve) => ({ ...curve, name: "" }));
  const all = [];
  if (tips.length > 0) {
    const toughness = (across) => ranked.slice(0, 1).map((tip) => (
      { name: "", color: "#8a93a0", thickness: 1, x: tip[across], y: tip.fracture_toughness }));
    all.push(plot("KI", "Pa√m", [...toughness("time"), ...of("mode_1", "time")]));
    all.push(plot("KII", "Pa√m", unnamed(of("mode_2", "time"))));
    all.push(plot("J", "J/m²", unnamed(of("j_integral", "time"))));
    const grown = ranked.filter((tip) => tip.length[tip.length.length - 1] > tip.length[0]);
    if (grown.length > 0) {
      all.push(plot("KI over length", "Pa√m", unnamed([...toughness("length"), ...of("mode_1", "length")]), "m"));
    }
    const [tip] = ranked.filter((tip) => tip.contours.length > 0);
    if (tip) {
      all.push(plot(`J by radius, ${tip.name}`, "J/m²", [
        ...tip.contours.map((of_radius) => ({
          name: "", color: "#8a93a088", thickness: 1, x: of_radius.time, y: of_radius.contour })),
        ...tip.contours.map((of_radius, i) => ({
          name: `${of_radius.cells} cells`, color: palette[i], x: of_radius.time, y: of_radius.domain })),
        { name: "circle alone", color: "#8a93a0", x: [], y: [] },
      ]));
    }
  }
  const names = {
    external_work: "work done", strain: "strain", kinetic: "kinetic", crack: "cracks", damping: "damping", rest: "rest",
  };
  const known = Object.entries(names).filter(([key]) => energies[key].length > 0);
  all.push(plot("energy", "J/m", known.map(([key, name], i) => (
    { name, color: palette[i], x: energies.time, y: energies[key] }))));
  if (supports.length > 0) {
    // Along the way that each has gone in the end.
    const sign = (support) => Math.sign(support.displacement[support.displacement.length - 1]) || 1;
    all.push(plot("load over displacement", "N/m", supports.map((support, i) => ({
      name: i < palette.length ? support.name : "", color: palette[i] || "#8a93a055", time: support.time,
      x: support.displacement.map((way) => sign(support) * way), y: support.force.map((force) => sign(support) * force),
    })), "m"));
  }
  return all;
}

// Controls.

function go(index) {
  state.frame = Math.max(0, Math.min(packed.length - 1, index));
  return show();
}

function play(playing) {
  state.playing = playing;
  element("play").textContent = playing ? "Pause" : "Play";
  if (playing && state.frame === packed.length - 1) go(0);
}

element("timeline").max = packed.length - 1;
element("speed").value = facts.playback;
element("timeline").addEventListener("input", (event) => { play(false); go(Number(event.target.value)); });
element("play").addEventListener("click", () => play(!state.playing));
element("explode").addEventListener("input", (event) => { state.explode = Number(event.target.value); arrange(); });
["outside", "inside", "colliders", "edges"].forEach((id) => element(id).addEventListener("change", arrange));
element("color").addEventListener("change", show);
element("front").addEventListener("click", () => look(0, 0));
window.addEventListener("keydown", (event) => {
  if (event.target.matches("input[type=number], select")) return;
  if (event.key === " ") { play(!state.playing); event.preventDefault(); }
  if (event.key === "ArrowRight") { play(false); go(state.frame + 1); event.preventDefault(); }
  if (event.key === "ArrowLeft") { play(false); go(state.frame - 1); event.preventDefault(); }
});

function resize() {
  const { clientWidth: width, clientHeight: height } = renderer.domElement;
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
  plots.forEach((plot) => plot.draw());
  wanted = true;
}

let due = 0;
function tick(now) {
  if (state.playing && now >= due && shown === state.frame) {
    due = now + 1000 / Math.max(1, Number(element("speed").value) || 24);
    if (state.frame < packed.length - 1) go(state.frame + 1); else play(false);
  }
  if (wanted) {
    wanted = false;
    renderer.render(scene, camera);
  }
  requestAnimationFrame(tick);
}

const plots = allPlots();
element("note").textContent = `Vertices are rounded to ${quantity(facts.rounding, "m")}; ` + (packed.length < facts.all_frames
  ? `${packed.length} of ${facts.all_frames} frames are here, to keep the page small. ` : "all frames are here. ") +
  `Drag turns, right drag moves, the wheel goes nearer. ${facts.tool}, scene ${facts.scene_hash.slice(0, 12)}.`;
window.addEventListener("resize", resize);
resize();

/** The part of the address behind # may say where to begin: #frame=12&explode=0.5&yaw=-25&pitch=18 */
const asked = new URLSearchParams(location.hash.slice(1));
const number = (key, otherwise) => (asked.has(key) ? Number(asked.get(key)) : otherwise);
state.explode = number("explode", 0);
element("explode").value = state.explode;
const begin = facts.frames.findIndex((frame) => frame.number === number("frame", facts.frames[0].number));
const turn = [number("yaw", -25), number("pitch", 18)].map((degrees) => degrees * Math.PI / 180);
look(...turn).then(() => go(Math.max(0, begin))).then(() => {
  document.documentElement.dataset.ready = "true";
  requestAnimationFrame(tick);
});
