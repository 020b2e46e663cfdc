// Tests the report of `pliant track` in a browser: all pictures and charts are visible, and the page uses no network.
"use strict";
const assert = require("assert");
const fs = require("fs");
const path = require("path");

async function checkReport({ browser, folder, pliant }) {
  let rows = "frame,ty,jawOpen,browInnerUpLeft,qw,qx,qy,qz\n";
  for (let k = 0; k < 24; ++k) {
    const yaw = 0.2 * Math.sin(k / 4);
    rows += `${k},0,${0.15 * Math.sin(k / 5) ** 2},${k / 24},${Math.cos(yaw / 2)},0,${Math.sin(yaw / 2)},0\n`;
  }
  fs.writeFileSync(path.join(folder, "q.csv"), rows);
  pliant("render", "face.plm", "--params", "q.csv", "-o", "v.y4m", "--truth-points", "t.csv");
  const first = fs.readFileSync(path.join(folder, "t.csv"), "utf8").split("\n").filter(line => /^0,ibug/.test(line));
  fs.writeFileSync(path.join(folder, "p.csv"), "landmark,x,y\n" + first.map(line => line.slice(2)).join("\n") + "\n");
  const summary = pliant("track", "face.plm", "--frames", "v.y4m", "--init", "p.csv", "--out", "t.csv", "--report", "r.html");
  await browser.open(path.join(folder, "r.html"), 1100, 900);
  assert.strictEqual(await browser.value(`[...document.images].filter(i => i.naturalWidth >= 320).length`), 9);
  assert.strictEqual(await browser.value(`[...document.images].filter(i => i.getBoundingClientRect().width < 200).length`), 0);
  assert(await browser.value(`document.body.textContent.includes(${JSON.stringify(summary.trim())})`), "no summary");
  for (const selector of ["path.line", "rect.bar", "rect.state-tracking"])
    assert(await browser.value(`[...document.querySelectorAll("${selector}")].some(e => e.getBoundingClientRect().width > 1)`), selector);
  // The yaw covers 23 degrees, so that its line fills its chart.
  assert(await browser.value(`document.querySelector("path.line").getBoundingClientRect().height > 80`), "a flat line");
  assert(await browser.value(`document.documentElement.scrollWidth <= innerWidth`), "wider than the window");
  assert.deepStrictEqual(browser.requests(), []);
  assert.deepStrictEqual(browser.complaints(), []);
}

module.exports = { checkReport };
