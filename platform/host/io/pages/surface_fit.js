// A model as numbers, and the fit of its pose and parameters to handles that a person has placed.
//
// The shape is a polynomial of the second degree in the parameters (render/shape_expansion.hpp). A view is that of
// camera.hpp: x = c + s (p'_xy + tau) / (1 + s/f p'_z) with p' = R diag(1,-1,-1) p, the focal length f fixed. The fit minimises
// the squared distances of the placed handles in standard deviations, and what parameters and pose differ from the start in
// theirs, by Levenberg and Marquardt's method. All pixel positions within this file are undistorted but those of `project`.
"use strict";

const kFit = {
  // Standard deviation of a placed handle as a fraction of the diagonal of all handles: as LandmarkFitTuning::point_sd_fraction.
  handleSd: 0.01,
  // Standard deviations of the pose around the start. They only matter where the handles leave something open, and then the
  // largest moves: one handle shifts the model, two also turn and scale it in the picture, further ones tilt it.
  shiftSd: 1000,  // in sizes of the model
  rollSd: 10, scaleSd: 10,  // rad, log
  tiltSd: 1.5,  // rad
  // Handles up to which other solutions are tried, since few handles have several. With more they are tried where the cost is above
  // this a handle: a handle is more than two standard deviations away on average.
  fewHandles: 9, goodCost: 4,
  // A solution that lies elsewhere replaces the present one if its cost is below this fraction.
  clearlyBetter: 0.7,
  // Steps, at most: while a handle is dragged, when it is let go, and of each other solution that is tried then.
  stepsOfMoves: 4, steps: 12, stepsOfOthers: 8, tolerance: 1e-3,
};

// ---- reading

const bytesOf = text => Array.from(atob(text), c => c.charCodeAt(0));
/// Bytes in which each zero is followed by the number of zeros that it stands for.
function withRuns(packed) {
  const out = [];
  for (let k = 0; k < packed.length; ++k)
    if (packed[k] !== 0) out.push(packed[k]);
    else for (let zeros = packed[++k]; zeros > 0; --zeros) out.push(0);
  return out;
}
/// Signed little-endian integers.
function integers(list, bytes) {
  const view = new DataView(Uint8Array.from(list).buffer), out = new Float32Array(list.length / bytes);
  for (let k = 0; k < out.length; ++k) out[k] = bytes === 1 ? view.getInt8(k) : view.getInt16(2 * k, true);
  return out;
}
/// Vectors point by point, of numbers that are all x, then all y and all z.
const interleaved = (list, count, scale) => Float32Array.from(list, (_, k) => scale * list[k % 3 * count + Math.floor(k / 3)]);
/// Points with their movements: start (3 numbers a point, mm), moves (an array of the same for each term, mm per unit).
function unpackPoints(data, bytes) {
  const count = data.points, all = integers(withRuns(bytesOf(data.moves)), bytes);
  const moves = data.moveScales.map((scale, k) => interleaved(all.slice(3 * count * k, 3 * count * (k + 1)), count, scale));
  return { count, start: interleaved(integers(bytesOf(data.start), 2), count, data.startScale), moves };
}
/// The model of the page: what `page_surface` writes (commands/points_surface.hpp).
function openSurface(data, width, height) {
  const parameters = data.parameters, values = parameters.map(p => p.value), camera = data.camera;
  const surface = {
    parameters, camera, terms: data.terms, facing: data.facing, lens: makeLens(camera, width, height),
    handles: unpackPoints(data.handles, 2), wire: unpackPoints(data.wire, 1),
    corners: Array.from(integers(bytesOf(data.corners), 2), x => x & 65535),
    start: { turn: data.q, tau: [data.t[0], data.t[1]], s: camera.f / data.t[2], values },
  };
  surface.startFactors = factors(surface, values);
  const x = shapeOf(surface, surface.handles, surface.start).map(p => projectIdeal(surface, surface.start, p)).filter(Boolean);
  const extent = k => Math.max(...x.map(p => p[k])) - Math.min(...x.map(p => p[k]));
  surface.sizePx = Math.max(10, Math.hypot(extent(0), extent(1)));
  return surface;
}

// ---- shape

/// The factor of each term: a parameter, or a product of two.
function factors(surface, values) {
  return surface.terms.map(([a, b]) => values[a] * (b < 0 ? 1 : values[b]));
}
/// Positions [x, y, z] (mm, model axes) of all points of a set.
function shapeOf(surface, set, state) {
  const out = Float32Array.from(set.start), now = factors(surface, state.values);
  now.forEach((factor, k) => {
    const change = factor - surface.startFactors[k], move = set.moves[k];
    if (change !== 0) for (let i = 0; i < out.length; ++i) out[i] += change * move[i];
  });
  return Array.from({ length: set.count }, (_, i) => out.subarray(3 * i, 3 * i + 3));
}
/// Adds the derivatives of handle i along each parameter: `column(parameter, dx, dy, dz)`.
function eachDerivative(surface, state, i, column) {
  surface.terms.forEach(([a, b], k) => {
    const move = surface.handles.moves[k], at = 3 * i;
    const add = (parameter, by) => { if (by !== 0) column(parameter, by * move[at], by * move[at + 1], by * move[at + 2]); };
    add(a, b < 0 ? 1 : state.values[b]);
    if (b >= 0) add(b, state.values[a]);
  });
}

// ---- rotations

function product(p, q) {
  return [p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]];
}
const conjugate = q => [q[0], -q[1], -q[2], -q[3]];
/// The quaternion of a rotation vector, and back.
function turnBy(x, y, z) {
  const angle = Math.hypot(x, y, z), k = angle > 1e-9 ? Math.sin(angle / 2) / angle : 0.5;
  return [Math.cos(angle / 2), k * x, k * y, k * z];
}
function rotationVector(q) {
  const length = Math.hypot(q[1], q[2], q[3]), angle = 2 * Math.atan2(length, Math.abs(q[0]));
  const k = (q[0] < 0 ? -1 : 1) * (length > 1e-9 ? angle / length : 2);
  return [k * q[1], k * q[2], k * q[3]];
}
/// The rows of R diag(1,-1,-1).
function matrixOf([w, x, y, z]) {
  return [[1 - 2 * (y * y + z * z), -2 * (x * y - w * z), -2 * (x * z + w * y)],
          [2 * (x * y + w * z), -1 + 2 * (x * x + z * z), -2 * (y * z - w * x)],
          [2 * (x * z - w * y), -2 * (y * z + w * x), -1 + 2 * (x * x + y * y)]];
}
const rotated = (m, p) => m.map(row => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);

// ---- camera

/// Undistorted image position of a point, or null if it is too near or behind the camera.
function projectIdeal(surface, state, p, m = matrixOf(state.turn)) {
  const r = rotated(m, p), depth = 1 + state.s / surface.camera.f * r[2];
  if (!(depth >= 0.2)) return null;
  const g = state.s / depth;
  return [surface.camera.cx + g * (r[0] + state.tau[0]), surface.camera.cy + g * (r[1] + state.tau[1])];
}
/// The lens of lens.hpp: the polynomial up to beyond the corners of the picture, and its tangent from there on.
function makeLens({ f, cx, cy, k1, k2, aspect }, width, height) {
  const radius = r => r * (1 + r * r * (k1 + k2 * r * r)), slope = r => 1 + r * r * (3 * k1 + 5 * k2 * r * r);
  const corner = 1.05 * Math.hypot(Math.max(cx + 0.5, width - 0.5 - cx) / f, Math.max(cy + 0.5, height - 0.5 - cy) / (aspect * f));
  let end = 0;
  while (radius(end) < corner && end < 4 * corner) end += corner / 256;
  const seen = r => r < end ? radius(r) : radius(end) + slope(end) * (r - end);
  const ideal = wanted => {
    let low = 0, high = end + Math.max(0, wanted - radius(end)) / slope(end) + 1e-6;
    for (let k = 0; k < 50; ++k) seen((low + high) / 2) < wanted ? low = (low + high) / 2 : high = (low + high) / 2;
    return (low + high) / 2;
  };
  const scaled = (map, x, y) => { const r = Math.hypot(x, y), k = r > 1e-12 ? map(r) / r : 1; return [k * x, k * y]; };
  return {
    distort(x) {
      const [a, b] = scaled(seen, (x[0] - cx) / f, (x[1] - cy) / f);
      return [cx + f * a, cy + aspect * f * b];
    },
    undistort(x) {
      const [a, b] = scaled(ideal, (x[0] - cx) / f, (x[1] - cy) / (aspect * f));
      return [cx + f * a, cy + f * b];
    },
  };
}
/// Image positions of a set of points as the picture has them; null for those behind the camera.
function project(surface, set, state) {
  const m = matrixOf(state.turn);
  return shapeOf(surface, set, state).map(p => projectIdeal(surface, state, p, m)).map(x => x && surface.lens.distort(x));
}

// ---- fit

/// Lower triangle of normal equations A x = g, and the cost that they belong to.
function makeNormal(n) {
  return { n, a: Array.from({ length: n }, (_, i) => new Float64Array(i + 1)), g: new Float64Array(n), cost: 0 };
}
/// Adds one row: `residual` changes by `row` along the unknowns.
function addRow(normal, row, residual, weight) {
  const used = [];
  for (let i = 0; i < normal.n; ++i) if (row[i] !== 0) used.push(i);
  normal.cost += weight * residual * residual;
  for (const i of used) {
    const w = weight * row[i], line = normal.a[i];
    normal.g[i] -= w * residual;
    for (const j of used) {
      if (j > i) break;
      line[j] += w * row[j];
    }
  }
}
/// Unknowns: turn about x, y, z, log s, tau, then the parameters.
function addHandle(surface, state, m, p, pin, normal) {
  const r = rotated(m, p), f = surface.camera.f, depth = 1 + state.s / f * r[2];
  const x = projectIdeal(surface, state, p, m), weight = 1 / (kFit.handleSd * surface.sizePx) ** 2;
  if (x === null) {  // behind the camera: no step may lead there
    normal.cost += weight * (100 * surface.sizePx) ** 2;
    return;
  }
  const g = state.s / depth, k = state.s / f / depth;
  const off = [x[0] - surface.camera.cx, x[1] - surface.camera.cy], z = [-k * off[0], -k * off[1]];
  const rows = [new Float64Array(normal.n), new Float64Array(normal.n)];
  rows[0].set([z[0] * r[1], g * r[2] - z[0] * r[0], -g * r[1], off[0] + z[0] * r[2], g, 0]);
  rows[1].set([-g * r[2] + z[1] * r[1], -z[1] * r[0], g * r[0], off[1] + z[1] * r[2], 0, g]);
  eachDerivative(surface, state, pin.handle, (parameter, dx, dy, dz) => {
    for (const c of [0, 1])
      rows[c][6 + parameter] += g * (m[c][0] * dx + m[c][1] * dy + m[c][2] * dz) + z[c] * (m[2][0] * dx + m[2][1] * dy + m[2][2] * dz);
  });
  addRow(normal, rows[0], x[0] - pin.x[0], weight);
  addRow(normal, rows[1], x[1] - pin.x[1], weight);
}
/// Adds the distance of pose and parameters from the start.
function addPriors(surface, state, normal) {
  const start = surface.start, away = rotationVector(product(state.turn, conjugate(start.turn)));
  const shift = kFit.shiftSd * surface.sizePx / state.s;
  const add = (unknown, residual, sd) => {
    normal.a[unknown][unknown] += 1 / sd ** 2;
    normal.g[unknown] -= residual / sd ** 2;
    normal.cost += (residual / sd) ** 2;
  };
  [kFit.tiltSd, kFit.tiltSd, kFit.rollSd].forEach((sd, k) => add(k, away[k], sd));
  add(3, Math.log(state.s / start.s), kFit.scaleSd);
  add(4, state.tau[0] - start.tau[0], shift);
  add(5, state.tau[1] - start.tau[1], shift);
  surface.parameters.forEach((p, k) => add(6 + k, state.values[k] - start.values[k], p.sd));
}
function linearise(surface, pins, state) {
  const normal = makeNormal(6 + surface.parameters.length), m = matrixOf(state.turn);
  const shape = shapeOf(surface, surface.handles, state);
  for (const pin of pins) addHandle(surface, state, m, shape[pin.handle], pin, normal);
  addPriors(surface, state, normal);
  return normal;
}
/// Parameters at a limit that the cost would push beyond it stay where they are.
function holdAtLimits(surface, state, normal) {
  surface.parameters.forEach((p, k) => {
    const u = 6 + k, value = state.values[k];
    if (!(value <= p.minimum && normal.g[u] < 0) && !(value >= p.maximum && normal.g[u] > 0)) return;
    normal.g[u] = 0;
    normal.a[u].fill(0);
    for (let i = u; i < normal.n; ++i) normal.a[i][u] = 0;
    normal.a[u][u] = 1;
  });
}
/// Solves (A + lambda diag A) x = g by Cholesky's factorisation; null if that is not positive definite.
function solveDamped({ n, a, g }, lambda) {
  const l = a.map(row => Float64Array.from(row)), x = Float64Array.from(g);
  for (let i = 0; i < n; ++i) {
    l[i][i] *= 1 + lambda;
    for (let j = 0; j <= i; ++j) {
      let sum = l[i][j];
      for (let k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      if (i === j && !(sum > 0)) return null;
      l[i][j] = i === j ? Math.sqrt(sum) : sum / l[j][j];
    }
    for (let k = 0; k < i; ++k) x[i] -= l[i][k] * x[k];
    x[i] /= l[i][i];
  }
  for (let i = n - 1; i >= 0; --i) {
    x[i] /= l[i][i];
    for (let k = 0; k < i; ++k) x[k] -= l[i][k] * x[i];
  }
  return x;
}
/// The state moved by a step, within the parameters' limits and between a distance of 50 mm and 100 m.
function movedState(surface, state, step) {
  const f = surface.camera.f, turn = product(turnBy(step[0], step[1], step[2]), state.turn), length = Math.hypot(...turn);
  return {
    turn: turn.map(x => x / length),
    s: Math.max(1e-5 * f, Math.min(2e-2 * f, state.s * Math.exp(Math.max(-2, Math.min(2, step[3]))))),
    tau: [state.tau[0] + step[4], state.tau[1] + step[5]],
    values: state.values.map((v, k) => Math.max(surface.parameters[k].minimum, Math.min(surface.parameters[k].maximum, v + step[6 + k]))),
  };
}
/// Minimises from one state. Undamped steps first: damping would turn and scale where the priors only shift. \return { state, cost }
function descend(surface, pins, from, steps) {
  let state = from, normal = linearise(surface, pins, state), lambda = 0;
  for (let k = 0; k < steps; ++k) {
    const cost = normal.cost;
    holdAtLimits(surface, state, normal);
    const step = solveDamped(normal, lambda);
    const next = step && movedState(surface, state, step), there = next && linearise(surface, pins, next);
    if (there && there.cost <= cost) {
      [state, normal] = [next, there];
      lambda = lambda > 1e-3 ? lambda / 10 : 0;
      if (cost - there.cost < kFit.tolerance * (1e-3 + there.cost)) break;
    } else {
      lambda = Math.max(1e-3, 10 * lambda);
      if (lambda > 1e6) break;
    }
  }
  return { state, cost: normal.cost };
}
/// The view from which the model's outline is much the same, but which is tilted the other way.
function tiltedBack(surface, state) {
  const n = rotated(matrixOf(state.turn), surface.facing), sine = Math.hypot(n[0], n[1]);
  const angle = sine > 1e-6 ? 2 * Math.atan2(sine, -n[2]) / sine : 0;
  return tilted(state, -angle * n[1], angle * n[0]);
}
const tilted = (state, x, y) => ({ ...state, turn: product(turnBy(x, y, 0), state.turn) });
/// States from which another solution may be reached: the start; the other tilt, with the same deformation or the opposite one; and
/// tilts of the present view with the shape of the start.
function otherStates(surface, state) {
  const back = tiltedBack(surface, state), start = surface.start.values;
  const values = state.values.map((v, k) => Math.max(surface.parameters[k].minimum, Math.min(surface.parameters[k].maximum, 2 * start[k] - v)));
  const plain = { ...state, values: start };
  return [surface.start, back, { ...back, values }, ...[[0.5, 0], [-0.5, 0], [0, 0.5], [0, -0.5]].map(([x, y]) => tilted(plain, x, y))];
}
const idealPins = (surface, pins) => pins.map(pin => ({ handle: pin.handle, x: surface.lens.undistort(pin.x) }));

/// Fits pose and parameters to pins [{ handle, x: [px, px] }], from `state`: for each move of a handle. \return the new state.
function fitToPins(surface, pins, state) {
  return descend(surface, idealPins(surface, pins), state, kFit.stepsOfMoves).state;
}
/// The same, for when a handle is let go: takes another solution if there is one that is clearly better.
function settle(surface, pins, state) {
  const ideal = idealPins(surface, pins);
  let best = descend(surface, ideal, state, kFit.steps), least = kFit.clearlyBetter * best.cost;
  const isGood = best.cost < kFit.goodCost * pins.length;
  if (pins.length < 3 || (pins.length > kFit.fewHandles && isGood)) return best.state;
  const first = best;
  for (const other of otherStates(surface, best.state)) {
    const found = descend(surface, ideal, other, kFit.stepsOfOthers);
    if (found.cost < least) [best, least] = [found, found.cost];
  }
  return best === first ? best.state : descend(surface, ideal, best.state, kFit.steps).state;
}

if (typeof module !== "undefined")
  module.exports = { kFit, openSurface, project, fitToPins, settle, shapeOf, matrixOf, rotationVector, product, conjugate, descend, movedState };
