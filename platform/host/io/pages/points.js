// The handles over the photograph: drawing, dragging, undo, and the file with their positions. The model follows by
// surface_fit.js. Picture coordinates: x right, y down, pixel centres at integers; the scene's group has them as its own.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const byId = id => document.getElementById(id);
const view = byId("view"), scene = byId("scene"), label = byId("label");
// `isPlaced`: a person put the handle where it is. `choice`: switched on or off by a person; null: as the model is turned.
const points = data.points.map(p => ({ name: p.name, u: p.u, v: p.v, x: p.x, y: p.y, normal: p.normal, isWanted: p.wanted,
                                       isPlaced: p.placed, choice: null, isBehind: false }));
const find = name => points.find(p => p.name === name);
const surface = openSurface(data.surface, data.width, data.height);
let model = surface.start;  // pose and parameters
let zoom = 1, panX = 0, panY = 0, chosen = null, showsNames = false, showsCurves = true, showsWire = true, follows = true;
let fitMs = 0;  // of the last step

const isOn = p => p.isPlaced || (p.choice !== null ? p.choice : p.isWanted && !p.isBehind);

// ---- the model follows
function updateHandles() {
  const x = project(surface, surface.handles, model), m = matrixOf(model.turn), shape = shapeOf(surface, surface.handles, model);
  const depth = surface.camera.f / model.s;
  points.forEach((p, i) => {
    const n = rotated(m, p.normal), r = rotated(m, shape[i]), sight = [r[0] + model.tau[0], r[1] + model.tau[1], r[2] + depth];
    p.isBehind = x[i] === null || n[0] * sight[0] + n[1] * sight[1] + n[2] * sight[2] >= data.turnedAway * Math.hypot(...sight);
    p.model = x[i];
    if (!p.isPlaced && x[i] && follows) [p.x, p.y] = x[i];
  });
}
/// Moves the model to the placed handles. \param fit  fitToPins while one is dragged, settle when it is let go.
function moveModel(fit) {
  if (!follows) return;
  const pins = points.map((p, i) => ({ handle: i, x: [p.x, p.y], isPlaced: p.isPlaced })).filter(pin => pin.isPlaced);
  const begin = performance.now();
  model = pins.length ? fit(surface, pins, model) : surface.start;
  fitMs = performance.now() - begin;
  updateHandles();
}

// ---- undo: whole states, so that nothing can be forgotten
const past = [];
const state = () => JSON.stringify([model, points.map(p => [p.x, p.y, p.isPlaced, p.choice])]);
function remember() {
  const now = state();
  if (past[past.length - 1] !== now) past.push(now);
  if (past.length > 500) past.shift();
}
function undo() {
  if (past.length === 0) return;
  const [before, places] = JSON.parse(past.pop());
  model = before;
  places.forEach(([x, y, isPlaced, choice], i) => Object.assign(points[i], { x, y, isPlaced, choice }));
  updateHandles();
  draw();
}

// ---- drawing
function element(name, attributes, parent) {
  const e = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) e.setAttribute(key, attributes[key]);
  return parent.appendChild(e);
}
function makeRow(p) {
  p.row = byId("list").appendChild(document.createElement("label"));
  p.box = p.row.appendChild(document.createElement("input"));
  p.box.type = "checkbox";
  p.row.appendChild(document.createElement("span")).textContent = p.name;
  p.where = p.row.appendChild(document.createElement("span"));
  p.where.className = "where";
  p.box.addEventListener("change", () => toggle(p));
  p.row.addEventListener("pointerenter", () => choose(p));
}
for (const p of [...points].reverse())  // the first on top
  p.group = element("g", { class: "point", "data-name": p.name }, byId("dots"));
for (const p of points) {
  p.hit = element("circle", { class: "hit" }, p.group);
  p.dot = element("circle", { class: "dot" }, p.group);
  p.text = element("text", {}, byId("texts"));
  p.text.textContent = p.name;
  makeRow(p);
}
const chains = data.chains.map(c => ({ closed: c.closed, points: c.names.map(find).filter(Boolean),
                                       path: element("path", { class: "curve" }, byId("lines")) }));
const wires = [element("path", { class: "wire below" }, byId("wires")), element("path", { class: "wire" }, byId("wires"))];
const pulls = element("path", { class: "pull" }, byId("wires"));
const edges = edgesOf(surface.corners);

/// Edges [a, b, face, other face] of triangles; a face of -1: there is none.
function edgesOf(corners) {
  const found = new Map();
  for (let i = 0; i < corners.length; ++i) {
    const face = Math.floor(i / 3), a = corners[i], b = corners[i % 3 === 2 ? i - 2 : i + 1];
    const key = Math.min(a, b) * 65536 + Math.max(a, b), edge = found.get(key);
    if (edge) edge[3] = face;
    else found.set(key, [a, b, face, -1]);
  }
  return [...found.values()];
}
/// The edges of all faces that face the camera.
function wirePath() {
  const x = project(surface, surface.wire, model), c = surface.corners, isFront = [];
  for (let i = 0; i < c.length; i += 3) {
    const [p, q, r] = [x[c[i]], x[c[i + 1]], x[c[i + 2]]];
    isFront.push(p && q && r && (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 0);
  }
  const text = p => p[0].toFixed(1) + " " + p[1].toFixed(1);
  return edges.filter(e => isFront[e[2]] || isFront[e[3]]).map(e => "M" + text(x[e[0]]) + "L" + text(x[e[1]])).join("");
}
/// A smooth curve through points: each arc's ends lean along the line between the neighbours.
function smoothPath(p, closed) {
  const n = p.length, at = i => p[closed ? (i + n) % n : Math.max(0, Math.min(n - 1, i))];
  let d = `M${p[0].x} ${p[0].y}`;
  for (let i = 0; i < (closed ? n : n - 1); ++i) {
    const [a, b, c, e] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    d += `C${b.x + (c.x - a.x) / 6} ${b.y + (c.y - a.y) / 6} ${c.x - (e.x - b.x) / 6} ${c.y - (e.y - b.y) / 6} ${c.x} ${c.y}`;
  }
  return d;
}
function drawPoint(p) {
  const on = isOn(p), where = `${p.x.toFixed(1)}, ${p.y.toFixed(1)}`;
  p.group.setAttribute("class", "point" + (on ? "" : " off") + (p.isPlaced ? " placed" : "") + (p === chosen ? " chosen" : ""));
  p.group.setAttribute("transform", `translate(${p.x} ${p.y})`);
  p.hit.setAttribute("r", 11 / zoom);
  p.dot.setAttribute("r", 4 / zoom);
  p.text.style.display = showsNames ? "" : "none";
  if (showsNames) {
    p.text.setAttribute("x", p.x + 6 / zoom);
    p.text.setAttribute("y", p.y - 4 / zoom);
    p.text.style.fontSize = 11 / zoom + "px";
    p.text.style.strokeWidth = 2.5 / zoom + "px";
  }
  p.box.checked = on;
  p.where.textContent = on ? where : p.choice === null && p.isWanted && p.isBehind ? "behind" : "off";
  p.row.className = (p === chosen ? "chosen" : "") + (p.isPlaced ? " placed" : "");
}
function drawModel() {
  const d = showsWire && follows ? wirePath() : "";
  for (const wire of wires) wire.setAttribute("d", d);
  const placed = points.filter(p => p.isPlaced && p.model);
  pulls.setAttribute("d", follows ? placed.map(p => `M${p.x} ${p.y}L${p.model[0]} ${p.model[1]}`).join("") : "");
  for (const c of chains) {
    const used = c.points.filter(isOn);
    c.path.setAttribute("d", showsCurves && used.length > 1 ? smoothPath(used, c.closed && used.length === c.points.length) : "");
  }
}
function draw() {
  scene.setAttribute("transform", `translate(${panX} ${panY}) scale(${zoom})`);
  points.forEach(drawPoint);
  drawModel();
  byId("count").textContent = `${points.filter(isOn).length} of ${points.length} points on, ${points.filter(p => p.isPlaced).length} placed`;
  byId("follow").checked = follows;
  label.hidden = chosen === null;
  if (chosen !== null) {
    const notes = chosen.isPlaced ? "  (placed)" : isOn(chosen) ? "" : "  (off)";
    label.textContent = `${chosen.name}  ${chosen.x.toFixed(1)}, ${chosen.y.toFixed(1)}${notes}`;
    label.style.left = panX + chosen.x * zoom + 14 + "px";
    label.style.top = panY + chosen.y * zoom - 28 + "px";
  }
}
function choose(p) {
  chosen = p;
  draw();
}

// ---- zoom and pan
/// Shows a box of the picture as large as it fits.
function showBox(left, top, right, bottom) {
  const { width, height } = view.getBoundingClientRect();
  zoom = Math.min(width / (right - left), height / (bottom - top));
  panX = (width - (left + right) * zoom) / 2;
  panY = (height - (top + bottom) * zoom) / 2;
  draw();
}
const fitView = () => showBox(-0.5, -0.5, data.width - 0.5, data.height - 0.5);
/// Shows the points with room around them, or the whole picture if that is smaller.
function showPoints() {
  const used = points.filter(isOn), side = k => used.map(p => p[k]);
  const centre = k => (Math.min(...side(k)) + Math.max(...side(k))) / 2, half = k => 0.8 * (Math.max(...side(k)) - Math.min(...side(k)));
  const reach = Math.max(20, half("x"), half("y"));
  if (used.length === 0 || 2 * reach > Math.min(data.width, data.height)) fitView();
  else showBox(centre("x") - reach, centre("y") - reach, centre("x") + reach, centre("y") + reach);
}
function zoomAt(x, y, factor) {
  const next = Math.max(0.05, Math.min(60, zoom * factor));
  panX = x - (x - panX) * next / zoom;
  panY = y - (y - panY) * next / zoom;
  zoom = next;
  draw();
}
view.addEventListener("wheel", e => {
  e.preventDefault();
  const box = view.getBoundingClientRect();
  zoomAt(e.clientX - box.left, e.clientY - box.top, Math.exp(-e.deltaY * 0.0015));
}, { passive: false });

// ---- dragging: a point keeps its distance from the pointer, so that it can be seen
let drag = null;
const pointOf = target => { const g = target.closest(".point"); return g && find(g.dataset.name); };
function place(p, x, y) {
  Object.assign(p, { x, y, isPlaced: true, choice: null });
}
view.addEventListener("pointerdown", e => {
  const p = pointOf(e.target);
  if (p) remember();
  drag = p ? { p, x: p.x, y: p.y } : { x: panX, y: panY };
  Object.assign(drag, { fromX: e.clientX, fromY: e.clientY, hasMoved: false });
  view.setPointerCapture(e.pointerId);
  view.classList.toggle("panning", !p);
  choose(p || null);
});
view.addEventListener("pointermove", e => {
  if (drag === null) {
    const p = pointOf(e.target);
    if (p && p !== chosen) choose(p);
    return;
  }
  const dx = e.clientX - drag.fromX, dy = e.clientY - drag.fromY;
  drag.hasMoved = drag.hasMoved || dx !== 0 || dy !== 0;
  if (drag.p && drag.hasMoved) {
    place(drag.p, drag.x + dx / zoom, drag.y + dy / zoom);
    moveModel(fitToPins);
  } else if (!drag.p) {
    panX = drag.x + dx;
    panY = drag.y + dy;
  }
  draw();
});
const drop = () => {
  if (drag && drag.p && drag.hasMoved) moveModel(settle);
  if (drag && drag.p && past[past.length - 1] === state()) past.pop();
  drag = null;
  view.classList.remove("panning");
  draw();
};
view.addEventListener("pointerup", drop);
view.addEventListener("pointercancel", drop);

/// Switches a point off or on. One that is off no longer holds the model.
function toggle(p) {
  remember();
  const wasOn = isOn(p), wasPlaced = p.isPlaced;
  Object.assign(p, { choice: !wasOn, isPlaced: false });
  if (wasPlaced) moveModel(settle);
  choose(p);
}
/// Pins a point where it is, or leaves it to the model again.
function togglePlaced(p) {
  remember();
  if (p.isPlaced) p.isPlaced = false;
  else place(p, p.x, p.y);
  moveModel(settle);
  choose(p);
}
function setFollows(value) {
  remember();
  follows = value;
  moveModel(settle);
  draw();
}
view.addEventListener("dblclick", e => {
  const p = pointOf(document.elementFromPoint(e.clientX, e.clientY));
  if (p) toggle(p);
});

// ---- keyboard
function nudge(p, dx, dy) {
  remember();
  place(p, p.x + dx, p.y + dy);
  moveModel(settle);
  draw();
}
addEventListener("keydown", e => {
  if (e.ctrlKey || e.metaKey) {
    if (e.key === "z") { e.preventDefault(); undo(); }
    if (e.key === "s") { e.preventDefault(); save(); }
    return;
  }
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const box = view.getBoundingClientRect(), step = e.shiftKey ? 0.1 : 0.5;
  if (e.key in steps && chosen) nudge(chosen, steps[e.key][0] * step, steps[e.key][1] * step);
  else if ((e.key === "x" || e.key === "X" || e.key === "Delete") && chosen) toggle(chosen);
  else if ((e.key === "p" || e.key === "P") && chosen) togglePlaced(chosen);
  else if (e.key === "Tab") choose(points[(points.indexOf(chosen) + (e.shiftKey ? points.length - 1 : 1) + points.length) % points.length]);
  else if (e.key === "f") setFollows(!follows);
  else if (e.key === "n") byId("names").click();
  else if (e.key === "c") byId("curves").click();
  else if (e.key === "w") byId("wire").click();
  else if (e.key === "0") fitView();
  else if (e.key === "+" || e.key === "-") zoomAt(box.width / 2, box.height / 2, e.key === "+" ? 1.25 : 0.8);
  else return;
  e.preventDefault();
});

// ---- points.csv
function csv() {
  const uv = p => data.hasUv ? `,${p.u},${p.v}` : "";
  return (data.hasUv ? "landmark,x,y,u,v,placed\n" : "landmark,x,y,placed\n") +
    points.filter(isOn).map(p => `${csvCell(p.name)},${p.x.toFixed(2)},${p.y.toFixed(2)}${uv(p)},${p.isPlaced ? 1 : 0}\n`).join("");
}
function save() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
  link.download = "points.csv";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
/// Takes on the points of a file: those in it are on, and placed where it says unless its column `placed` has a 0; all others are
/// off. Returns what was wrong, or "".
function load(text) {
  const rows = csvRows(text);
  const columns = ["landmark", "x", "y"].map(name => rows.length ? rows[0].indexOf(name) : -1);
  if (columns.includes(-1)) return "not a points file: the first line must have landmark, x and y";
  const column = rows[0].indexOf("placed");
  const found = rows.slice(1).map(row => ({ p: find(row[columns[0]]), name: row[columns[0]], x: parseFloat(row[columns[1]]),
                                            y: parseFloat(row[columns[2]]), isPlaced: row[column] !== "0" }));
  const bad = found.filter(f => !Number.isFinite(f.x) || !Number.isFinite(f.y));
  if (bad.length) return "not a position: " + bad.map(f => f.name).join(", ");
  remember();
  for (const p of points) Object.assign(p, { choice: false, isPlaced: false });
  for (const { p, x, y, isPlaced } of found) if (p) Object.assign(p, { x, y, isPlaced, choice: true });
  moveModel(settle);
  draw();
  const unknown = found.filter(f => !f.p).map(f => f.name);
  return unknown.length ? "not landmarks of this model: " + unknown.join(", ") : "";
}
byId("load").addEventListener("change", async e => {
  const problem = load(await e.target.files[0].text());
  if (problem) alert(e.target.files[0].name + ": " + problem);
  e.target.value = "";
});

// ---- buttons
/// Switches all points on, all off, or all off but those that are placed.
function switchAll(choice, keepsPlaced) {
  remember();
  for (const p of points) Object.assign(p, { choice, isPlaced: keepsPlaced && p.isPlaced });
  moveModel(settle);
  draw();
}
byId("save").addEventListener("click", save);
byId("undo").addEventListener("click", undo);
byId("fit").addEventListener("click", fitView);
byId("names").addEventListener("click", () => { showsNames = !showsNames; draw(); });
byId("curves").addEventListener("click", () => { showsCurves = !showsCurves; draw(); });
byId("wire").addEventListener("click", () => { showsWire = !showsWire; draw(); });
byId("follow").addEventListener("change", e => { setFollows(e.target.checked); e.target.blur(); });
byId("all-on").addEventListener("click", () => switchAll(true, true));
byId("all-off").addEventListener("click", () => switchAll(false, false));
byId("only-placed").addEventListener("click", () => switchAll(false, true));
addEventListener("resize", fitView);

const picture = scene.querySelector("image");
picture.setAttribute("width", data.width);
picture.setAttribute("height", data.height);
picture.setAttribute("href", data.picture);
updateHandles();
showPoints();
