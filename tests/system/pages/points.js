// Tests the page of `pliant points` in a browser while its model does not follow: drags a point, switches points off, saves and loads, then fits the saved points.
"use strict";
const assert = require("assert");
const fs = require("fs");
const path = require("path");

/// \param pliant  runs `pliant` with these arguments in the folder of the test and returns its output.
async function checkPoints({ browser, folder, pliant }) {
  const width = 320, height = 240, grey = Buffer.alloc(width * height);
  for (let i = 0; i < grey.length; ++i) grey[i] = 60 + (i % width) / 4 + (i / width) / 4;
  fs.writeFileSync(path.join(folder, "picture.pgm"), Buffer.concat([Buffer.from(`P5\n${width} ${height}\n255\n`), grey]));
  pliant("points", "face.plm", "--image", "picture.pgm", "--start", "100,60,120,140", "-o", "points.html");
  pliant("fit", "face.plm", "--box", "100,60,120,140", "--size", "320x240", "-o", "box.json");
  const page = path.join(folder, "points.html");
  assert(!/https?:\/\/(?!www\.w3\.org)/.test(fs.readFileSync(page, "utf8")), "the page names an address");
  await browser.open(page, 1200, 800);

  await browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
  const saved = path.join(folder, "points.csv");
  const save = async () => {
    fs.rmSync(saved, { force: true });
    await browser.value(`document.getElementById("save").click()`);
    await browser.until(() => fs.existsSync(saved) && fs.statSync(saved).size > 0, "points.csv");
    const lines = fs.readFileSync(saved, "utf8").trimEnd().split("\n");
    assert.strictEqual(lines[0], "landmark,x,y,placed");
    return new Map(lines.slice(1).map(line => line.split(",")).map(([name, x, y]) => [name, { x: +x, y: +y }]));
  };
  const centre = name => browser.value(`(() => { const b = document.querySelector('[data-name="${name}"] .dot')
    .getBoundingClientRect(); return { x: b.x + b.width / 2, y: b.y + b.height / 2 }; })()`);
  const near = (a, b, tolerance) => Math.hypot(a.x - b.x, a.y - b.y) <= tolerance;

  const before = await save();
  assert.strictEqual(before.size, 68);
  assert(await browser.value(`document.querySelector("image").getBoundingClientRect().width > 300`), "no picture");
  // The picture lies under the points: its pixel (0,0) has its centre at (0,0).
  const zoom = await browser.value(`document.querySelector("image").getBoundingClientRect().width / ${width}`);
  const corner = await browser.value(`(() => { const b = document.querySelector("image").getBoundingClientRect();
    return { x: b.x, y: b.y }; })()`);
  const tip = await centre("ibug30");
  assert(near({ x: (tip.x - corner.x) / zoom - 0.5, y: (tip.y - corner.y) / zoom - 0.5 }, before.get("ibug30"), 0.05));

  // While the model does not follow, dragging moves only that point, by the same distance.
  await browser.key("f");
  await browser.drag(tip, { x: tip.x + 40, y: tip.y - 25 });
  const moved = await save();
  for (const [name, x] of before) {
    const expected = name === "ibug30" ? { x: x.x + 40 / zoom, y: x.y - 25 / zoom } : x;
    assert(near(moved.get(name), expected, 0.02), name + " is in the wrong place");
  }
  assert(await browser.value(`document.getElementById("label").textContent.startsWith("ibug30")`), "no name shown");

  // Keys move a point and switch it off. A double click switches it off too. Undo restores it.
  await browser.key("ArrowRight");
  await browser.key("ArrowDown", { modifiers: 8 });
  const nudged = (await save()).get("ibug30");
  assert(near(nudged, { x: moved.get("ibug30").x + 0.5, y: moved.get("ibug30").y + 0.1 }, 0.011));
  await browser.key("x");
  await browser.click(await centre("ibug08"), 2);
  const fewer = await save();
  assert.deepStrictEqual([...before.keys()].filter(name => !fewer.has(name)), ["ibug08", "ibug30"]);
  for (let k = 0; k < 5; ++k) await browser.key("z", { modifiers: 2 });
  const back = await save();
  assert.deepStrictEqual([...back], [...before]);

  // Zooming and panning do not change the position of a point in the picture.
  await browser.mouse("mouseWheel", tip.x, tip.y, { deltaX: 0, deltaY: -700 });
  await browser.drag({ x: 40, y: 100 }, { x: 90, y: 130 });
  assert.deepStrictEqual([...await save()], [...before]);

  // Loading switches on the points of the file, at its positions, and all others off. A file without points changes nothing.
  const file = path.join(folder, "some.csv");
  fs.writeFileSync(file, "landmark,x,y\r\n\"ibug36\",100.5,90.25\r\nibug45,200,91\r\n");
  const { root } = await browser.send("DOM.getDocument");
  const { nodeId } = await browser.send("DOM.querySelector", { nodeId: root.nodeId, selector: "#load" });
  await browser.send("DOM.setFileInputFiles", { nodeId, files: [file] });
  await browser.until(() => browser.value(`document.getElementById("count").textContent.startsWith("2 of")`), "loading");
  assert.deepStrictEqual([...await save()], [["ibug36", { x: 100.5, y: 90.25 }], ["ibug45", { x: 200, y: 91 }]]);
  assert(/not a points file/.test(await browser.value(`load("frame,q\\n0,1\\n")`)));
  assert(/not landmarks of this model: ear/.test(await browser.value(`load("landmark,x,y\\near,1,2\\nibug36,3,4\\n")`)));
  assert.deepStrictEqual([...await save()], [["ibug36", { x: 3, y: 4 }]]);

  // A name of any characters comes back.
  assert.strictEqual(await browser.value(`(() => { Object.assign(points[0], { name: 'corner, "upper"', isPlaced: true });
    return load(csv()) || (points[0].isPlaced ? "" : "not on"); })()`), "");
  await browser.value(`points[0].name = "ibug00"`);

  // `fit` reads the saved file.
  await browser.value(`document.getElementById("all-on").click()`);
  await browser.value(`(past.length = 1, undo())`);
  await save();
  assert(/68 points/.test(pliant("fit", "face.plm", "--points", "points.csv", "--size", "320x240", "-o", "f.json")));
  assert.deepStrictEqual(browser.requests(), []);
  assert.deepStrictEqual(browser.complaints(), []);
}

module.exports = { checkPoints };
