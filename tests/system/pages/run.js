// Tests the pages that `pliant` writes in a headless Chromium. Exits with 77 and a message if there is no Chromium.
// usage: node run.js PLIANT FIXTURES
"use strict";
const { execFileSync } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");
const { Chromium } = require("./chromium");
const { checkPoints } = require("./points");
const { checkFace, checkSheet } = require("./points_follow");
const { checkReport } = require("./report");

const names = ["chromium", "chromium-browser", "google-chrome"];
const program = (process.env.PATH || "").split(":").flatMap(dir => names.map(name => path.join(dir, name))).find(p => fs.existsSync(p));
if (!program) {
  console.log("skipped: no chromium on this machine");
  process.exit(77);
}
const [, , command, fixtures] = process.argv;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "pliant_pages_"));
const pliant = (...words) => execFileSync(command, words, { cwd: folder, encoding: "utf8" });

process.exitCode = 1;  // until all checks have passed
(async () => {
  pliant("bake", path.join(fixtures, "face"), "-o", "face.plm");
  for (const check of [checkPoints, checkSheet, checkFace, checkReport]) {
    const browser = new Chromium(program);
    try {
      await check({ browser, folder, pliant, fixtures });
      console.log(check.name + ": passed");
    } finally {
      await browser.close();
    }
  }
})().then(() => 0, error => (console.error(error), 1)).then(code => {
  fs.rmSync(folder, { recursive: true, force: true });
  process.exit(code);
});
