// Controls a headless Chromium through its debugging pipe. Needs only the modules of Node.
"use strict";
const { spawn } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");

class Chromium {
  constructor(program) {
    this.profile = fs.mkdtempSync(path.join(os.tmpdir(), "pliant_chromium_"));
    this.process = spawn(program, ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync", "--remote-debugging-pipe",
      "--user-data-dir=" + this.profile], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.next = 0;
    this.waiting = new Map();
    this.events = [];
    let buffer = "";
    this.process.stdio[4].setEncoding("utf8");
    this.process.stdio[4].on("data", part => {
      buffer += part;
      for (let end; (end = buffer.indexOf("\0")) >= 0; buffer = buffer.slice(end + 1)) this.receive(JSON.parse(buffer.slice(0, end)));
    });
    this.process.stdio[3].on("error", () => {});
    this.has_ended = false;
    this.closed = new Promise(resolve => {
      const end = () => {
        // Else Node, left without work, would end with success.
        this.has_ended = true;
        for (const { reject } of this.waiting.values()) reject(new Error("Chromium has ended"));
        this.waiting.clear();
        resolve();
      };
      this.process.on("exit", end);
      this.process.on("error", end);
    });
  }
  receive(message) {
    if (message.id === undefined) return this.events.push(message);
    const { resolve, reject } = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.error) reject(new Error(message.error.message));
    else resolve(message.result);
  }
  send(method, params = {}) {
    if (this.has_ended) return Promise.reject(new Error("Chromium has ended"));
    const id = ++this.next;
    this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId: this.session }) + "\0");
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }
  async open(file, width, height) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    this.session = (await this.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    for (const domain of ["Page", "Runtime", "Network", "DOM", "Log"]) await this.send(domain + ".enable");
    await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    this.events = [];
    await this.send("Page.navigate", { url: "file://" + file });
    await this.until(() => this.events.some(e => e.method === "Page.loadEventFired"), "the page to load");
  }
  async until(condition, what, seconds = 20) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
      const value = await condition();
      if (value) return value;
      await new Promise(resolve => setTimeout(resolve, 30));
    }
    throw new Error("waited too long for " + what);
  }
  /// The value of an expression in the page.
  async value(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception ? exceptionDetails.exception.description : exceptionDetails.text);
    return result.value;
  }
  mouse(type, x, y, more = {}) {
    return this.send("Input.dispatchMouseEvent", { type, x, y, ...more });
  }
  async drag(from, to) {
    const held = { button: "left", buttons: 1, clickCount: 1 };
    await this.mouse("mouseMoved", from.x, from.y);
    await this.mouse("mousePressed", from.x, from.y, held);
    for (const fraction of [0.3, 0.7, 1])
      await this.mouse("mouseMoved", from.x + fraction * (to.x - from.x), from.y + fraction * (to.y - from.y), held);
    await this.mouse("mouseReleased", to.x, to.y, { ...held, buttons: 0 });
  }
  async click(at, count = 1) {
    for (let k = 1; k <= count; ++k)
      for (const type of ["mousePressed", "mouseReleased"])
        await this.mouse(type, at.x, at.y, { button: "left", buttons: type === "mousePressed" ? 1 : 0, clickCount: k });
  }
  async key(key, more = {}) {
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, ...more });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, ...more });
  }
  async screenshot(file) {
    fs.writeFileSync(file, Buffer.from((await this.send("Page.captureScreenshot")).data, "base64"));
  }
  /// Addresses that the page requested, without its own and those of embedded data.
  requests() {
    return this.events.filter(e => e.method === "Network.requestWillBeSent").map(e => e.params.request.url)
      .filter(url => !/^(file|data|blob|about):/.test(url));
  }
  /// Errors and warnings of the page.
  complaints() {
    return this.events.filter(e => e.method === "Runtime.exceptionThrown" ||
      (e.method === "Log.entryAdded" && e.params.entry.level === "error")).map(e => JSON.stringify(e.params));
  }
  async close() {
    this.session = undefined;
    this.send("Browser.close").catch(() => {});
    const late = setTimeout(() => this.process.kill("SIGKILL"), 5000);
    await this.closed;
    clearTimeout(late);
    fs.rmSync(this.profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
  }
}

module.exports = { Chromium };
