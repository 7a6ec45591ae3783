// Shows a machine while it draws, and hands on what a person asks.
const data = JSON.parse($("data").textContent);
const sums = (steps) => { let sum = 0; return steps.map((step) => (sum += step) * 1e-3); };
const meant = { x: sums(data.meant.x), y: sums(data.meant.y), s: Array.from(data.meant.s, Number), length: data.meant.s.length };
const way = { x: [], y: [], s: [], length: 0 };
const WINDOW = 30; // seconds that the charts show
let last = null, latest = null, layer = null, painted = 0, socket = null;

// Before it begins: the drawing in its order, in the colours of its pens, with the travels between.
const order = { x: data.order.x.map((x) => x * 1e-3), y: data.order.y.map((y) => y * 1e-3), s: data.order.s, length: data.order.s.length };
const isPreview = () => order.length > 0 && last !== null && ["connecting", "ready"].includes(last.state);
function paintOrder(canvas) {
  const { ratio, scale } = canvas, shown = Math.round(order.length * $("order").value / 1000);
  const way = { x: [0, ...order.x.slice(0, shown)], y: [0, ...order.y.slice(0, shown)], s: [0, ...order.s.slice(0, shown)] };
  const thick = Math.max(1.6 * ratio, Math.min(0.35 * scale, 12 * ratio));
  const pens = Array.from({ length: 8 }, (_, pen) => [DRAWN | 28, DRAWN | (pen << 2), colour(pen ? "pen" + pen : "ink"), thick]);
  strokes(way, 1, shown + 1, canvas, [[DRAWN, 0, colour("travel"), ratio, [2 * ratio, 5 * ratio]], ...pens]);
  if (shown) pen(canvas, way.x[shown], way.y[shown], (way.s[shown] & DRAWN) !== 0);
}

const sheet = new Sheet($("sheet"), (canvas) => {
  const { context, ratio, scale } = canvas;
  const thick = Math.max(2.6 * ratio, Math.min(0.35 * scale, 12 * ratio));
  if (isPreview()) { paintOrder(canvas); return; }
  strokes(meant, 1, meant.length, canvas, [[DRAWN, DRAWN, colour("meant"), ratio]]);
  const key = [canvas.X(0), canvas.Y(0), scale, context.canvas.width, context.canvas.height, colour("ink")].join();
  if (!layer || layer.key !== key || painted > way.length) {
    layer = document.createElement("canvas");
    layer.width = context.canvas.width; layer.height = context.canvas.height;
    layer.key = key; painted = 0;
  }
  const ink = layer.getContext("2d");
  ink.lineJoin = ink.lineCap = "round";
  const styles = [[DRAWN, 0, colour("travel"), ratio, [2 * ratio, 5 * ratio]], [DRAWN, DRAWN, colour("ink"), thick]];
  strokes(way, painted, way.length, { context: ink, X: canvas.X, Y: canvas.Y, ratio }, styles);
  painted = way.length;
  context.drawImage(layer, 0, 0);
  if (data.by_done && last) { // nothing tells the way: what is done is drawn as it was meant
    let done = 0;
    while (done < order.length && data.order.way[done] <= last.way_mm * 1e3 + 0.5) done++;
    strokes({ x: [0, ...order.x], y: [0, ...order.y], s: [0, ...order.s] }, 1, done + 1, canvas, styles);
  }
  if (latest && way.length) { // the end that is not settled
    const end = { x: [way.x.at(-1), latest[0]], y: [way.y.at(-1), latest[1]], s: [0, latest[2]] };
    strokes(end, 1, 2, canvas, styles);
  }
  strokes(meant, 1, meant.length, canvas, [[DRAWN, DRAWN, colour("meant"), Math.max(1, ratio * 0.8)]]);
  if (last && last.next) crosshair(canvas, last.next[0], last.next[1]);
  if (last) pen(canvas, last.at[0], last.at[1], last.pen === "down");
});
sheet.box = data.box;

const curve = (role, label, run) => ({ role, label, run, points: [] });
const charts = ["X", "Y"].map((name) => new Chart($("charts"), name, "mm", [curve("target", "target", "steps"), curve("desired", "on the line"), curve("actual", "actual")]));
const error = new Chart($("charts"), "contour error", "mm", [curve("error", "distance from the line")]);
if (!data.lines) charts.push(error); else error.canvas.closest("section")?.remove();

const fixed = (value, digits, unit) => value === null || value === undefined ? "–" : value.toFixed(digits) + " " + unit;
const clock = (s) => {
  if (s === null || s === undefined) return "–";
  const whole = Math.round(s), two = (n) => String(n).padStart(2, "0");
  if (whole < 60) return whole + " s";
  return whole < 3600 ? Math.floor(whole / 60) + " min " + two(whole % 60) + " s" : Math.floor(whole / 3600) + " h " + two(Math.floor(whole / 60) % 60) + " min";
};
const duty = (share, motor) => share === undefined ? "not told by this machine"
  : (share * 100).toFixed(1) + " %" + (data.supply_v ? ", " + (share * data.supply_v[motor]).toFixed(1) + " V" : "");
const BANNERS = {
  connecting: ["", "Waiting for the machine to answer."], locked: ["bad", ""], homing: ["", "Searching for the limit switches."],
  ready: ["", "Ready: press Start to draw."], watching: ["", data.hand ? "No drawing: the machine is led by hand." : "Watching: there is no drawing to send."], running: ["good", "Drawing."],
  paused: ["", data.lines ? "Paused, the pen is lifted: Resume puts it back where it was." : "Paused: the target under way is finished, then the pen is up; Resume puts it back where it was."],
  stopped: ["bad", data.lines ? "EMERGENCY STOP. Resume unlocks the machine and lifts the pen." : "EMERGENCY STOP. Resume lets the motors go on."], done: ["good", "Finished."], failed: ["bad", ""],
};

function banner(kind, text) {
  $("banner").className = "banner " + kind;
  $("banner").textContent = text;
  $("banner").hidden = !text;
}

function take(update) {
  last = update;
  if (update.afresh) { way.x = []; way.y = []; way.s = []; way.length = 0; painted = 0; layer = null; }
  for (let n = 0; n < update.way.length; n += 3) {
    way.x.push(update.way[n] * 1e-3); way.y.push(update.way[n + 1] * 1e-3); way.s.push(update.way[n + 2]);
  }
  way.length = way.x.length;
  if (data.hand && !data.lines) sheet.box = reach();
  latest = update.last && [update.last[0] * 1e-3, update.last[1] * 1e-3, update.last[2]];
  for (const [time, at, line, target] of update.samples) {
    [0, 1].forEach((axis) => {
      const [targets, desired, actual] = charts[axis].curves;
      targets.points.push(target && [time, target[axis], target[axis]]);
      desired.points.push(line && [time, line[axis], line[axis]]);
      actual.points.push([time, at[axis], at[axis]]);
    });
    const off = line && Math.hypot(line[0] - at[0], line[1] - at[1]);
    error.curves[0].points.push(line && [time, off, off]);
  }
  for (const chart of charts) {
    for (const each of chart.curves) if (each.points.length > 4000) each.points.splice(0, each.points.length - 3000);
    chart.span = [Math.max(0, update.time_s - WINDOW), Math.max(update.time_s, 1)];
    chart.changed();
  }
  const [kind, text] = BANNERS[update.state];
  const wants = update.wants && !["stopped", "running"].includes(update.state) ? update.wants : "";
  const wanted = wants.match(/^pen (\d+) is wanted/);
  $("banner").style.borderLeft = wanted ? "16px solid " + colour(wanted[1] < 2 ? "ink" : "pen" + ((wanted[1] - 2) % 7 + 1)) : "";
  const given = wanted && data.pens[wanted[1]], named = given && (given.match(/#[0-9a-f]{6}/i) || [given])[0];
  if (named && CSS.supports("color", named)) $("banner").style.borderLeftColor = named;
  banner(kind, update.state === "failed" ? update.failure + " The recording up to here is kept." : wants ? wants[0].toUpperCase() + wants.slice(1) + "." : text);
  document.body.dataset.state = update.state;
  $("start").disabled = update.state !== "ready";
  $("pause").disabled = update.state !== "running";
  if (data.hand) {
    const free = ["ready", "watching", "paused"].includes(update.state), held = update.state === "locked" || update.state === "stopped";
    for (const each of $("hand").querySelectorAll("button")) each.disabled = !free;
    for (const name of ["home", "unlock"]) $("hand").querySelector("[data-ask=" + name + "]").disabled = name === "home" ? !(free || held) : !held;
    if (update.by_hand) banner("", "By hand: " + update.by_hand[0] + " of " + update.by_hand[1] + " done.");
    $("hand").querySelector("[data-ask=next]").disabled = !(free && update.targets !== null);
    $("order").parentNode.parentNode.hidden = !isPreview();
    if (data.lines && document.activeElement !== $("feed")) { $("feed").value = update.feed_percent; $("feed-said").textContent = update.feed_percent + " %"; }
  }
  $("resume").disabled = update.state !== "paused" && update.state !== "stopped";
  $("stop").disabled = update.state === "done" || update.state === "failed";
  $("progress").value = update.targets ? update.sent / update.targets : 0;
  fill($("done"), [
    [data.lines ? "operations done" : "targets done", update.targets === null ? String(update.sent) : update.sent + " of " + update.targets],
    ...(data.lines ? [] : [["reached", String(update.reached)]]),
    ["remaining", update.state === "done" ? "–" : clock(update.remaining_s ?? (isPreview() ? data.takes_s : null))],
    ["recording", update.recording],
  ]);
  const next = update.next || [null, null], shares = update.duty || [];
  fill($("now"), [
    ["time", clock(update.time_s)],
    ["pen", update.pen],
    ["position x", fixed(update.at[0], 3, "mm")], ["position y", fixed(update.at[1], 3, "mm")],
    ["next x", fixed(next[0], 3, "mm")], ["next y", fixed(next[1], 3, "mm")],
    ["speed x", fixed(update.speed_mm_s[0], 1, "mm/s")], ["speed y", fixed(update.speed_mm_s[1], 1, "mm/s")],
    ...(data.lines ? [] : [[data.ramps ? "duty first" : "duty x", duty(shares[0], 0)], [data.ramps ? "duty second" : "duty y", duty(shares[1], 1)],
    ["contour error", fixed(update.error_mm, 4, "mm")], ["greatest, drawn", fixed(update.worst_mm, 4, "mm")]]),
    ["anomalies", String(update.anomalies)],
  ]);
  $("messages").replaceChildren(...update.messages.slice().reverse().map(([time, words]) => {
    const row = document.createElement("tr");
    for (const [name, cellText] of [["time", time.toFixed(3) + " s"], ["", words]]) {
      const cell = document.createElement("td");
      cell.className = name; cell.textContent = cellText;
      row.append(cell);
    }
    return row;
  }));
}

let due = false;
function paint() { due = false; sheet.draw(); charts.forEach((chart) => chart.draw()); }

function ask(command) { if (socket && socket.readyState === WebSocket.OPEN) socket.send(command); }
function connect() {
  socket = new WebSocket(location.href.replace(/^http/, "ws").replace(/\/?$/, "/") + "socket");
  socket.onmessage = (event) => { take(JSON.parse(event.data)); if (!due) { due = true; requestAnimationFrame(paint); } };
  socket.onclose = () => {
    letGo();
    for (const name of ["start", "pause", "resume", "stop"]) $(name).disabled = true;
    if (last && (last.state === "done" || last.state === "failed")) return;
    banner("bad", "The program that drives the machine does not answer any more: this page stops nothing now.");
    setTimeout(connect, 1000);
  };
}
for (const name of ["start", "pause", "resume", "stop", "clear"]) {
  $(name).addEventListener("click", (event) => {
    if (event.detail > 0) $(name).blur(); // clicked, not chosen by the keyboard: Space is to pause, not to press it again
    if (name !== "stop" || event.timeStamp - pressed > 2000) ask(name);
  });
}
// At the press, not when the finger is lifted or has slid off; what clicks without a press stops too.
let pressed = -Infinity;
$("stop").addEventListener("pointerdown", (event) => { pressed = event.timeStamp; ask("stop"); });
// By hand: a step at each press, or, where the step is "held", on and on until it is let go.
const ARROWS = { ArrowLeft: "-1 0", ArrowRight: "1 0", ArrowUp: "0 1", ArrowDown: "0 -1" };
// How far the pen may go that way inside the machine's area, mm; a machine refuses what leads beyond it.
// The machine's area, as the origin of the drawing has it.
const reach = () => data.lines ? data.box : data.box.map((mm, n) => mm + last.p1[n % 2] - data.p1[n % 2]);
function room(x, y) {
  const [x0, y0, x1, y1] = reach(), along = (sign, at, low, high) => sign ? Math.max(0, sign < 0 ? at - low : high - at) : Infinity;
  return Math.min(along(x, last.at[0], x0, x1), along(y, last.at[1], y0, y1));
}
const PIECE_MS = 100; // a held key moves it by so much at a time: what stops asking, stops it
let held = null;
const value = (id) => Number($(id).value) || 0;
const jogSpeed = () => data.lines ? Math.max(0.1, value("jog-speed")) : TARGETS_MM_S;
// A machine of targets goes as fast as it does: a held key asks for so much of its way at a time.
const TARGETS_MM_S = 30;
function jogBy(direction, by) {
  const [x, y] = direction.split(" ").map(Number);
  if (by > 0) ask(["jog", x * by, y * by, jogSpeed()].join(" "));
}
function jog(direction) {
  const step = Number($("step").value), [x, y] = direction.split(" ").map(Number);
  if (step) { jogBy(direction, step); return; }
  letGo();
  if (data.ramps) { // one long move while it is held: the voltage grows by the machine's own ramp
    const hold = () => ask(["hold", x, y].join(" "));
    hold(); held = setInterval(hold, PIECE_MS);
    return;
  }
  const piece = (times) => jogBy(direction, Math.floor(Math.min(jogSpeed() * PIECE_MS * 1e-3 * times, room(x, y)) * 1e3) / 1e3);
  piece(2); // one ahead, so that it does not stop between two of them
  held = setInterval(() => piece(1), PIECE_MS);
}
// A count that way: 1 and 2 for x, 3 and 4 for y, forwards and back.
const pulse = (digit) => ask("pulse " + digit);
function letGo() { if (held !== null) { clearInterval(held); held = null; ask("end-jog"); } }
if (data.hand) {
  $("hand").hidden = $("keys-by-hand").hidden = false;
  $("keys-of-targets").hidden = data.lines;
  for (const each of document.querySelectorAll(data.lines ? ".targets" : ".lines")) each.hidden = true;
  $("pulse").addEventListener("click", () => pulse(1 + Math.floor(Math.random() * 4)));
  $("p1").addEventListener("click", () => ask(["p1", Math.round(value("p1-x")), Math.round(value("p1-y"))].join(" ")));
  for (const each of document.querySelectorAll("[data-jog]")) {
    each.addEventListener("pointerdown", (event) => { if (!each.disabled) { each.setPointerCapture(event.pointerId); jog(each.dataset.jog); } });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) each.addEventListener(name, letGo);
    each.addEventListener("click", (event) => { if (event.detail === 0) jog(each.dataset.jog); }); // by the keyboard
  }
  window.addEventListener("blur", letGo);
  for (const each of document.querySelectorAll("[data-ask]")) each.addEventListener("click", () => ask(each.dataset.ask));
  $("go").addEventListener("click", () => ask(["go", value("go-x"), value("go-y")].join(" ")));
  $("stands").addEventListener("click", () => ask(["origin", value("go-x"), value("go-y")].join(" ")));
  $("feed").addEventListener("input", () => { $("feed-said").textContent = $("feed").value + " %"; });
  $("feed").addEventListener("change", () => { ask("feed " + $("feed").value); $("feed").blur(); });
  $("pen-down-set").addEventListener("click", () => ask("pen-down " + Math.round(value("pen-down"))));
  const names = { line: ["to x", "to y"], rectangle: ["width", "height"], circle: ["radius", "points (0: by the error)"] };
  const usual = { line: [30, 10], rectangle: [30, 20], circle: [10, 72] };
  $("shape").addEventListener("change", () => ["a", "b"].forEach((id, n) => {
    $("shape-" + id + "-name").textContent = names[$("shape").value][n]; $("shape-" + id).value = usual[$("shape").value][n];
  }));
  $("draw-shape").addEventListener("click", () => ask([$("shape").value, ...["shape-x", "shape-y", "shape-a", "shape-b", "shape-speed", "shape-error"].map(value)].join(" ")));
}
$("order").addEventListener("input", () => {
  $("order-said").textContent = Math.round($("order").value / 10) + " %";
  sheet.draw();
});
window.addEventListener("keyup", (event) => { if (ARROWS[event.key]) letGo(); });
window.addEventListener("keydown", (event) => {
  if (event.key === "Escape") { event.preventDefault(); ask("stop"); return; } // always
  if (event.ctrlKey || event.altKey || event.metaKey || event.repeat || event.target.matches?.("button:enabled, input, select, summary")) return;
  if (data.hand && ARROWS[event.key]) { event.preventDefault(); jog(ARROWS[event.key]); return; }
  const running = last && last.state === "running";
  if (data.hand && !data.lines && last) { // as the published program has them
    if (event.key === "+") { event.preventDefault(); ask("next"); return; }
    if ("1234".includes(event.key)) { event.preventDefault(); pulse(event.key); return; }
    if (event.key === " " && ["ready", "watching"].includes(last.state)) { event.preventDefault(); pulse(1 + Math.floor(Math.random() * 4)); return; }
  }
  const command = { Enter: "start", " ": running ? "pause" : "resume", c: "clear", C: "clear" }[event.key];
  if (command) { event.preventDefault(); ask(command); }
});
window.addEventListener("repaint", () => { layer = null; charts.forEach((chart) => chart.changed()); paint(); });
$("title").textContent = data.title;
$("kind").textContent = data.simulated ? "SIMULATED MACHINE" : "REAL MACHINE";
$("about").textContent = data.about;
$("stops").textContent = data.stops;
fill($("facts"), data.facts);
connect();
