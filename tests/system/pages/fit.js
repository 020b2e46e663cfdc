// Tests the fit of the page of `pliant points` without a browser: a sheet and a face in many poses, whose handles are placed one
// after the other, as a person drags them, compared with the truth.
// usage: node fit.js PLIANT SOURCE_FOLDER FACE_PLM
"use strict";
const assert = require("assert");
const { execFileSync } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const [, , command, source, face] = process.argv;
const faceTable = path.resolve(face);
const fit = require(path.join(source, "platform/host/io/pages/surface_fit.js"));

const kSize = "640x480", kFocal = 900, kRadian = Math.PI / 180;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "pliant_page_fit_"));
const pliant = (...words) => execFileSync(command, words, { cwd: folder, encoding: "utf8" });
const mean = values => values.reduce((a, b) => a + b, 0) / values.length;
const dataOf = page => JSON.parse(fs.readFileSync(path.join(folder, page), "utf8").match(/id="data">(.*)<\/script>/)[1]);

/// Uniform numbers from 0 to 1, the same on every machine (Lehmer's generator).
let seed = 1;
const uniform = (low, high) => low + (high - low) * (seed = seed * 48271 % 2147483647) / 2147483647;

/// The page of a model from which everything starts, and pages of `count` random states, with what was drawn.
function makeStates(model, count, amount, lens) {
  const camera = lens ? ["--calibration", lens] : ["--focal", String(kFocal)];
  pliant("points", model, "--image", "grey.pgm", ...camera, "-o", "start.html");
  pliant("fit", model, "--size", kSize, ...camera, "--box", "200,80,240,320", "-o", "box.json");
  const start = dataOf("start.html"), json = JSON.parse(fs.readFileSync(path.join(folder, "box.json")));
  const states = [];
  for (let k = 0; k < count; ++k) {
    const [x, y, z] = [uniform(-35, 35), uniform(-35, 35), uniform(-40, 40)].map(a => a * kRadian / 2);
    const turns = [[Math.cos(z), 0, 0, Math.sin(z)], [Math.cos(y), 0, Math.sin(y), 0], [Math.cos(x), Math.sin(x), 0, 0]];
    const depth = start.surface.t[2] * uniform(0.8, 1.5);
    json.pose = { q: turns.reduce(fit.product), t: [uniform(-0.1, 0.1) * depth, uniform(-0.1, 0.1) * depth, depth] };
    for (const p of start.surface.parameters)
      json.parameters[p.name] = Math.max(p.minimum, Math.min(p.maximum, amount * p.sd * uniform(-1.7, 1.7)));
    fs.writeFileSync(path.join(folder, "state.json"), JSON.stringify({ ...json, points: [] }));
    pliant("points", model, "--image", "grey.pgm", "--start", "state.json", "-o", "state.html");
    states.push({ q: json.pose.q, handles: dataOf("state.html").points });
  }
  return { start, states };
}
/// Drags the handles of these numbers to their places, in five moves each. \return mean error, px; angle, degrees; ms of each move.
function place(start, state, numbers) {
  const surface = fit.openSurface(start.surface, start.width, start.height), pins = [], ms = [];
  let model = surface.start;
  const errors = () => fit.project(surface, surface.handles, model).map((x, i) => Math.hypot(x[0] - state.handles[i].x, x[1] - state.handles[i].y));
  for (const handle of numbers) {
    const from = fit.project(surface, surface.handles, model)[handle], to = state.handles[handle];
    const pin = { handle, x: from };
    pins.push(pin);
    for (const part of [0.2, 0.4, 0.6, 0.8, 1]) {
      pin.x = [from[0] + part * (to.x - from[0]), from[1] + part * (to.y - from[1])];
      const begin = process.hrtime.bigint();
      model = fit.fitToPins(surface, pins, model);
      ms.push(Number(process.hrtime.bigint() - begin) / 1e6);
    }
    model = fit.settle(surface, pins, model);
    assert(model.values.every((v, k) => v >= surface.parameters[k].minimum && v <= surface.parameters[k].maximum));
  }
  return { px: mean(errors()), degrees: Math.hypot(...fit.rotationVector(fit.product(model.turn, fit.conjugate(state.q)))) / kRadian, ms };
}
/// Median and 90 % of a list.
const quantiles = values => [0.5, 0.9].map(f => [...values].sort((a, b) => a - b)[Math.floor(f * (values.length - 1))]);
function check(what, { start, states }, names, limits) {
  const numbers = names.map(name => start.points.findIndex(p => p.name === name));
  assert(!numbers.includes(-1), "a handle has another name");
  const results = states.map(state => place(start, state, numbers));
  const [px, degrees, ms] = [results.map(r => r.px), results.map(r => r.degrees), results.flatMap(r => r.ms)].map(quantiles);
  console.log(`${what}: median ${px[0].toFixed(2)} px, ${degrees[0].toFixed(2)} deg; 90 % ${px[1].toFixed(2)} px, ${degrees[1].toFixed(2)} deg; ` +
              `a move ${ms[0].toFixed(2)} ms`);
  for (const k of [0, 1]) {
    assert(px[k] <= limits.px[k], `${what}: ${px[k]} px`);
    assert(degrees[k] <= limits.degrees[k], `${what}: ${degrees[k]} degrees`);
  }
  assert(ms[0] < 16, "a move takes longer than a frame of the screen");
}

/// Drags handles anywhere, far outside of the picture and onto each other: the state stays finite and within its limits, and the
/// model comes back when the handles do.
function checkWildDrags({ start, states }) {
  const surface = fit.openSurface(start.surface, start.width, start.height), count = start.points.length;
  let model = surface.start;
  for (let k = 0; k < 150; ++k) {
    const reach = [100, 1000, 1e5][k % 3], pins = [];
    for (let n = 1 + k % 7; n > 0; --n)
      pins.push({ handle: Math.floor(uniform(0, count - 0.01)), x: k % 5 ? [uniform(-reach, reach), uniform(-reach, reach)] : [320, 240] });
    model = (k % 2 ? fit.settle : fit.fitToPins)(surface, pins, model);
    const numbers = [...model.turn, model.s, ...model.tau, ...model.values];
    assert(numbers.every(Number.isFinite), "the state is not finite");
    assert(model.s > 0 && Math.abs(Math.hypot(...model.turn) - 1) < 1e-6);
    for (const x of fit.project(surface, surface.handles, model)) assert(x === null || x.every(Number.isFinite));
  }
  const pins = states[0].handles.map((p, handle) => ({ handle, x: [p.x, p.y] }));
  for (let k = 0; k < 10; ++k) model = fit.settle(surface, pins, model);
  return mean(fit.project(surface, surface.handles, model).map((x, i) => x ? Math.hypot(x[0] - pins[i].x[0], x[1] - pins[i].x[1]) : 1000));
}

function run() {
  fs.writeFileSync(path.join(folder, "grey.pgm"), Buffer.concat([Buffer.from("P5\n640 480\n255\n"), Buffer.alloc(640 * 480, 127)]));
  fs.writeFileSync(path.join(folder, "lens.yml"), "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n" +
    "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 700., 0., 330., 0., 720., 230., 0., 0., 1. ]\n" +
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.2, 0.05, 0., 0., 0. ]\n");
  pliant("bake", path.join(source, "fixtures/sheet"), "--modes", "6", "-o", "sheet.plm");
  const rigid = makeStates("sheet.plm", 10, 0), bent = makeStates("sheet.plm", 12, 0.7), all = bent.start.points.map(p => p.name);
  const corners = all.filter(name => /[01]\.00_[01]\.00/.test(name));
  const wild = checkWildDrags(bent);
  console.log(`after wild drags: sheet ${wild.toFixed(2)} px`);
  assert(wild < 1, "the model does not come back");
  check("flat sheet, 4 corners", rigid, corners, { px: [0.5, 1], degrees: [1, 2] });
  check("bent sheet, 4 corners", bent, corners, { px: [13, 20], degrees: [15, 60] });
  check("bent sheet, 9 handles", bent, all, { px: [0.5, 1.2], degrees: [1.2, 3] });
  check("bent sheet through a lens, 9 handles", makeStates("sheet.plm", 10, 0.7, "lens.yml"), all, { px: [0.5, 1.2], degrees: [1.2, 3] });
  const face = makeStates(faceTable, 10, 0.7), ibug = [...Array(68).keys()].map(k => "ibug" + String(k).padStart(2, "0"));
  check("face, 6 landmarks", face, ["ibug30", "ibug36", "ibug45", "ibug48", "ibug54", "ibug08"], { px: [3.5, 5], degrees: [4, 7] });
  const few = { start: face.start, states: face.states.slice(0, 4) };  // 340 moves each
  check("face, 68 landmarks", few, ibug, { px: [1, 1.2], degrees: [1.2, 2] });
}

try {
  run();
} finally {
  fs.rmSync(folder, { recursive: true, force: true });
}
