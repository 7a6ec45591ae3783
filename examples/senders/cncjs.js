#!/usr/bin/env node
// Leads the server of cncjs over its API, as its page in a browser does.
//
//   cncjs.js draw PORT FILE   the drawing, with a pause and a resume on its way
//   cncjs.js lead PORT        settings, homing, jog and its end, hold and resume, overrides, reset, unlock
//
// CNCJS is the folder that it was installed into. Its server listens on a free port of 127.0.0.1 and keeps
// its settings in a folder of its own, which is taken away at the end.
"use strict";
const fs = require("fs"), net = require("net"), os = require("os"), path = require("path");
const { spawn } = require("child_process");
const modules = path.join(process.env.CNCJS, "node_modules");
const io = require(path.join(modules, "socket.io-client"));
const jwt = require(path.join(modules, "jsonwebtoken"));

const PATIENCE_MS = 200_000;
const SECRET = "of a server that lives as long as this test";
const said = (words) => console.log("  " + words);
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

function freePort() {
  return new Promise((done) => {
    const server = net.createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => done(port));
    });
  });
}

class Led {
  constructor(port) {
    this.port = port;
    this.state = {};
    this.settings = {};
    this.sender = {};
    this.workflow = "idle";
    this.read = [];
  }

  async start() {
    this.home = fs.mkdtempSync(path.join(os.tmpdir(), "cncjs-"));
    const config = path.join(this.home, "cncrc");
    fs.writeFileSync(config, JSON.stringify({ secret: SECRET, checkForUpdates: false }));
    const http = await freePort();
    this.server = spawn(process.execPath, [path.join(modules, "cncjs", "bin", "cncjs"), "-H", "127.0.0.1", "-p", String(http), "-c", config],
      { env: { ...process.env, HOME: this.home }, stdio: ["ignore", "inherit", "inherit"] });
    const token = jwt.sign({ id: "", name: "" }, SECRET, { expiresIn: "1h" });
    this.socket = io(`http://127.0.0.1:${http}`, { query: { token }, reconnectionDelay: 200, reconnectionDelayMax: 500 });
    this.socket.on("controller:state", (_, state) => { this.state = state; });
    this.socket.on("controller:settings", (_, settings) => { this.settings = settings; });
    this.socket.on("sender:status", (status) => { this.sender = status; });
    this.socket.on("workflow:state", (state) => { this.workflow = state; });
    this.socket.on("serialport:read", (line) => { this.read.push(line); });
    await new Promise((done, failed) => {
      this.socket.once("startup", done);
      setTimeout(() => failed(new Error("cncjs does not answer")), PATIENCE_MS).unref();
    });
    await new Promise((done, failed) => this.socket.emit("open", this.port, { baudrate: 115200, controllerType: "Grbl" },
      (error) => error ? failed(new Error(`cncjs cannot open ${this.port}: ${JSON.stringify(error)}`)) : done()));
    await this.stands("Idle");
  }

  stop() {
    if (this.socket) this.socket.close();
    if (this.server) this.server.kill();
    fs.rmSync(this.home, { recursive: true, force: true });
  }

  command(...words) { this.socket.emit("command", this.port, ...words); }

  get active() { return (this.state.status || {}).activeState; }
  get at() { const { x, y } = this.state.status.mpos; return [Number(x), Number(y)]; }
  get overrides() { return (this.state.status.ov || []).map(Number); }

  async until(what, holds) {
    const end = Date.now() + PATIENCE_MS;
    while (!holds()) {
      if (Date.now() > end) throw new Error(`not seen: ${what}; ${JSON.stringify(this.state.status)}, sender ${JSON.stringify(this.sender)}, ${this.read.slice(-5)}`);
      await pause(20);
    }
  }

  async stands(...states) { await this.until(states.join(" or "), () => states.includes(this.active)); }
  here() { return `${this.active} at ${this.at}`; }
}

async function draw(led, file) {
  const text = fs.readFileSync(file, "latin1");
  await new Promise((done, failed) => led.socket.emit("command", led.port, "gcode:load", "drawing.gcode", text, (error) => error ? failed(error) : done()));
  led.command("gcode:start");
  await led.until("a third of the lines", () => led.sender.received > led.sender.total / 3);
  led.command("gcode:pause");
  await led.until("it stands", () => led.active === "Hold" && led.state.status.subState === 0);
  const held = led.at;
  await pause(1500); // as it asks for the parser's state meanwhile
  if (led.active !== "Hold" || String(led.at) !== String(held)) throw new Error(`it goes on while it is held: ${led.here()}`);
  said(`paused after ${led.sender.received} of ${led.sender.total} lines: ${led.here()}`);
  led.command("gcode:resume");
  await led.stands("Run");
  await led.until("all lines", () => led.sender.received === led.sender.total);
  await led.until("the end of the program", () => led.workflow === "idle" && led.active === "Idle");
  const errors = led.read.filter((line) => /^(error|ALARM)/.test(line));
  if (errors.length || String(led.at) !== "0,0") throw new Error(`${led.here()}: ${errors}`);
  said(`${led.sender.total} lines, the last one its own %wait; then ${led.here()}`);
}

async function lead(led) {
  const near = (x) => { if (Math.abs(led.at[0] - x) > 0.012) throw new Error(`x should be ${x}: ${led.here()}`); }; // mm: a step is 0.0114
  await led.until("its settings", () => (led.settings.settings || {})["$132"] !== undefined);
  said(`settings: ${Object.keys(led.settings.settings).length}, Grbl ${led.settings.version}, $110=${led.settings.settings.$110}`);
  led.command("gcode", "$22=1");
  await pause(600);
  led.command("homing");
  await led.stands("Home");
  await led.stands("Idle");
  near(0);
  said(`homed: ${led.here()}`);
  led.command("gcode", "$J=G91 X10 F1200");
  await led.stands("Jog");
  await led.stands("Idle");
  near(10);
  led.command("gcode", "$J=G91 X200 F600");
  await led.until("the jog on its way", () => led.active === "Jog" && led.at[0] > 11);
  led.command("jogCancel");
  await led.stands("Idle");
  if (led.at[0] > 209) throw new Error(`the jog was not cancelled: ${led.here()}`);
  said(`jogged by 10 mm, and on until it was cancelled: ${led.here()}`);
  const x = led.at[0];
  led.command("gcode", ["M3 S90", `G1 X${(x + 150).toFixed(3)} F300`]);
  await led.until("the line on its way", () => led.active === "Run" && led.at[0] > x + 0.5);
  led.command("feedhold");
  await led.until("it stands", () => led.active === "Hold" && led.state.status.subState === 0);
  said(`held: ${led.here()}`);
  led.command("cyclestart");
  await led.stands("Run");
  for (const [command, value, place, want] of [["feedOverride", 10, 0, 110], ["feedOverride", -1, 0, 109], ["feedOverride", 0, 0, 100],
    ["rapidOverride", 25, 1, 25], ["rapidOverride", 50, 1, 50], ["rapidOverride", 100, 1, 100],
    ["spindleOverride", -10, 2, 90], ["spindleOverride", 1, 2, 91], ["spindleOverride", 0, 2, 100]]) {
    led.command(command, value);
    await led.until(`${command} ${value}: ${want} %`, () => led.overrides[place] === want);
  }
  said(`overrides of feed, travels and power, each as reported; ${led.here()}`);
  await led.stands("Run");
  led.command("reset");
  await led.stands("Alarm");
  said(`reset on its way: ${led.here()}`);
  led.command("unlock");
  await led.stands("Idle");
  said(`unlocked: ${led.here()}`);
  led.command("gcode", "G0 X0 Y0");
  await led.until("back at the origin", () => led.active === "Idle" && String(led.at) === "0,0");
}

(async () => {
  const [, , what, port, ...rest] = process.argv;
  const led = new Led(port);
  let status = 0;
  try {
    await led.start();
    await ({ draw, lead })[what](led, ...rest);
  } catch (error) {
    console.error(error.message);
    status = 1;
  }
  led.stop();
  process.exit(status);
})();
