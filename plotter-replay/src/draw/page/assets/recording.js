// Plays a recording. What is packed is unpacked by the browser, and waited for: the page is ready when `data-ready` says so.
(async () => {
const data = JSON.parse($("data").textContent);

function sums(steps, unit) { // from differences
  const values = new Float64Array(steps.length);
  let sum = 0;
  for (let n = 0; n < steps.length; n++) { sum += steps[n]; values[n] = sum * unit; }
  return values;
}
function unpack({ x, y, s }) {
  return { x: sums(x, 1e-3), y: sums(y, 1e-3), s: Uint8Array.from(s, (digit) => digit.charCodeAt(0) - 48), length: s.length };
}
async function unzipped(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Uint8Array(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}
async function unpackWay({ unit_um, count, bytes }) { // times, x, y: differences in LEB128, x and y signed in the lowest bit; then states
  const packed = await unzipped(bytes);
  let at = 0;
  const column = (unit, isSigned) => {
    const values = new Float64Array(count);
    let sum = 0;
    for (let n = 0; n < count; n++) {
      let number = 0, place = 1, byte;
      do { byte = packed[at++]; number += (byte & 127) * place; place *= 128; } while (byte > 127);
      sum += isSigned ? (number % 2 ? -(number + 1) / 2 : number / 2) : number;
      values[n] = sum * unit;
    }
    return values;
  };
  return { t: column(unit_um * 1e-6, false), x: column(unit_um * 1e-3, true), y: column(unit_um * 1e-3, true), s: packed.subarray(at), length: count };
}
document.body.dataset.ready = "no";
const way = await unpackWay(data.way), meant = unpack(data.meant), undrawn = unpack(data.undrawn);
const targets = { t: sums(data.targets.t, 1e-6), x: sums(data.targets.x, 1e-3), y: sums(data.targets.y, 1e-3) };
const reached = sums(data.reached.t, 1e-6);
const first = data.first_us * 1e-6, last = Math.max(data.last_us * 1e-6, first + 1e-6);

function before(times, time) { // how many of sorted times are not after `time`
  let low = 0, high = times.length;
  while (low < high) { const middle = (low + high) >> 1; if (times[middle] <= time) low = middle + 1; else high = middle; }
  return low;
}
const gaps = data.gaps.map(([start, length]) => [start * 1e-6, (start + length) * 1e-6]).sort((a, b) => a[0] - b[0]);
function curve({ from_us, width_us, unit, low, high }, across) { // the middle of each stretch, least and greatest
  const points = [], width = width_us * 1e-6;
  let gap = 0, before = null;
  low.forEach((value, n) => {
    if (value === null) return;
    const time = (from_us + (n + 0.5) * width_us) * 1e-6;
    while (gap < gaps.length && gaps[gap][1] <= (before ? before[0] : 0)) gap++;
    const isAcross = before && gap < gaps.length && gaps[gap][0] > before[0] - width && gaps[gap][1] < time + width;
    // What stands while the line is silent is drawn as standing, not on its way to where it is next; what
    // nobody knows then is not drawn.
    if (isAcross && across === "stands") points.push([Math.min(gaps[gap][1], time), before[1], before[2]]);
    if (isAcross && across === "unknown") points.push(null);
    points.push(before = [time, value * unit, high[n] * unit]);
  });
  return points;
}
function at({ from_us, width_us, unit, low, high }, time) { // the greatest value in the stretch of a time
  let n = Math.floor((time * 1e6 - from_us) / width_us);
  n = Math.min(n, low.length - 1);
  while (n >= 0 && low[n] === null) n--;
  return n < 0 ? null : high[n] * unit;
}

// A recording too long for lines has a map instead: of each cell, since when there is ink.
let map = null;
if (data.ink) {
  const bytes = await unzipped(data.ink.cells), count = data.ink.wide * data.ink.high;
  map = { since: new Uint16Array(count), differs: new Uint8Array(count), canvas: document.createElement("canvas") };
  for (let n = 0; n < count; n++) { map.since[n] = (bytes[n] & 127) << 8 | bytes[count + n]; map.differs[n] = bytes[n] >> 7; }
  map.canvas.width = data.ink.wide; map.canvas.height = data.ink.high;
}
function paintMap({ context, X, Y }) {
  if (!map) return;
  const { wide, high, x_mm, y_mm, side_mm } = data.ink, share = (now - first) / (last - first) * 32766 + 1;
  const small = map.canvas.getContext("2d"), picture = small.createImageData(wide, high);
  const rgb = (name) => [1, 3, 5].map((at) => parseInt(colour(name).slice(at, at + 2), 16)).concat(255); // #rrggbb
  const [ink, faint, differs] = ["ink", "faint", "differs"].map(rgb);
  for (let row = 0; row < high; row++) for (let column = 0; column < wide; column++) {
    const n = row * wide + column, since = map.since[n];
    if (since === 0) continue;
    picture.data.set(since > share ? faint : map.differs[n] ? differs : ink, ((high - 1 - row) * wide + column) * 4);
  }
  small.putImageData(picture, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(map.canvas, X(x_mm), Y(y_mm + high * side_mm), X(x_mm + wide * side_mm) - X(x_mm), Y(y_mm) - Y(y_mm + high * side_mm));
}

const data_stands = data.stands_in_gaps;
const penColour = (state) => colour(state >> 2 & 7 ? "pen" + (state >> 2 & 7) : "ink");
const pens = [...new Set(Array.from(way.s, (state) => state >> 2 & 7))].sort();
let now = first, playing = null, painted = 0, layer = null;

const sheet = new Sheet($("sheet"), (canvas) => {
  const { context, ratio, scale } = canvas;
  const thick = Math.max(2.6 * ratio, Math.min(0.35 * scale, 12 * ratio));
  const done = before(way.t, now);
  if (data.ink) { paintMap(canvas); finishSheet(canvas); return; }
  // What is drawn by now grows on a layer of its own while view and size stay.
  const key = [canvas.X(0), canvas.Y(0), scale, context.canvas.width, context.canvas.height, colour("ink")].join();
  if (!layer || layer.key !== key || done < painted) {
    layer = document.createElement("canvas");
    layer.width = context.canvas.width; layer.height = context.canvas.height;
    layer.key = key; painted = 0;
  }
  strokes(way, 1, way.length, canvas, [[DRAWN, DRAWN, colour("faint"), Math.max(ratio, thick * 0.5)]]);
  const ink = layer.getContext("2d");
  ink.lineJoin = ink.lineCap = "round";
  const inked = { context: ink, X: canvas.X, Y: canvas.Y, ratio };
  strokes(way, painted, done, inked, [
    [DRAWN, 0, colour("travel"), ratio, [2 * ratio, 5 * ratio]],
    ...pens.map((pen) => [DRAWN | DIFFERS | 28, DRAWN | pen << 2, penColour(pen << 2), thick]), [DRAWN | DIFFERS, DRAWN | DIFFERS, colour("differs"), thick],
  ]);
  painted = done;
  context.drawImage(layer, 0, 0);
  const [x, y] = place(now);
  if (done > 0 && done < way.length && way.s[done] & DRAWN) {
    context.strokeStyle = way.s[done] & DIFFERS ? colour("differs") : penColour(way.s[done]); context.lineWidth = thick;
    context.beginPath(); context.moveTo(canvas.X(way.x[done - 1]), canvas.Y(way.y[done - 1])); context.lineTo(canvas.X(x), canvas.Y(y)); context.stroke();
  }
  finishSheet(canvas);
});
function finishSheet(canvas) { // what lies over the ink
  const { ratio } = canvas, [x, y, isDown] = place(now);
  strokes(meant, 1, meant.length, canvas, [[DRAWN, DRAWN, colour("meant"), ratio]]);
  strokes(undrawn, 1, undrawn.length, canvas, [[DRAWN, DRAWN, colour("undrawn"), 1.6 * ratio, [6 * ratio, 4 * ratio]]]);
  const next = before(targets.t, now) - 1;
  if (next >= 0) crosshair(canvas, targets.x[next], targets.y[next]);
  if (way.length) pen(canvas, x, y, isDown);
}

function place(time) { // of the pen: x, y, whether it is down, mm/s
  const n = before(way.t, time);
  if (n === 0) return [way.x[0] || 0, way.y[0] || 0, false, 0, 0];
  if (n === way.length) return [way.x[n - 1], way.y[n - 1], (way.s[n - 1] & DRAWN) !== 0, 0, 0];
  let start = way.t[n - 1];
  // It stands while the line is silent.
  const gap = data_stands && gaps.find(([from, to]) => from >= start - 1e-3 && to <= way.t[n] + 1e-3);
  if (gap) { start = Math.min(gap[1], way.t[n]); if (time <= start) return [way.x[n - 1], way.y[n - 1], (way.s[n - 1] & DRAWN) !== 0, 0, 0]; }
  const span = way.t[n] - start, share = span > 0 ? (time - start) / span : 1;
  const dx = way.x[n] - way.x[n - 1], dy = way.y[n] - way.y[n - 1];
  return [way.x[n - 1] + share * dx, way.y[n - 1] + share * dy, (way.s[n] & DRAWN) !== 0, span > 0 ? dx / span : 0, span > 0 ? dy / span : 0];
}

{ // all that is drawn and meant fits the sheet
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const widen = (x, y) => { box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y); box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y); };
  for (const lines of [way, meant, undrawn]) for (let n = 0; n < lines.length; n++) widen(lines.x[n], lines.y[n]);
  sheet.box = box[0] <= box[2] ? box : null;
}

const charts = data.charts.map(({ label, unit, curves }) => {
  const chart = new Chart($("charts"), label, unit, curves.map(({ role, label, run, data }) => ({ role, label, run, points: curve(data, run === "bars" ? "" : role === "error" ? "unknown" : data_stands ? "stands" : "") })), seek);
  chart.span = [first, last];
  chart.bands = gaps;
  return chart;
});

const fixed = (value, digits, unit) => value === null || value === undefined ? "–" : value.toFixed(digits) + " " + unit;
function show() {
  const [x, y, isDown, vx, vy] = place(now);
  const sent = before(targets.t, now), done = before(reached, now);
  const next = sent - 1, about = data.targets.every > 1 ? "about " : "";
  const gap = data.gaps.find(([start, length]) => now >= start * 1e-6 && now <= (start + length) * 1e-6);
  const count = (n, every, all) => Math.min(all, n * every);
  fill($("state"), [
    ["time", fixed(now, 6, "s")],
    ["pen", isDown ? "down" : "up"],
    ["position x", fixed(x, 3, "mm")], ["position y", fixed(y, 3, "mm")],
    ["next x", next < 0 ? "–" : about + fixed(targets.x[next], 3, "mm")],
    ["next y", next < 0 ? "–" : about + fixed(targets.y[next], 3, "mm")],
    ["speed x", fixed(vx, 1, "mm/s")], ["speed y", fixed(vy, 1, "mm/s")],
    ["contour error", fixed(at(data.charts[2].curves[0].data, now), 4, "mm")],
    ["pulse rate", fixed(at(data.charts[3].curves[0].data, now), 0, "/s")],
    ["targets sent", about + count(sent, data.targets.every, data.targets.count)],
    ["targets reached", (data.reached.every > 1 ? "about " : "") + count(done, data.reached.every, data.reached.count)],
    ["line", gap ? "silent" : "–"],
  ]);
  $("clock").textContent = now.toFixed(3) + " / " + last.toFixed(3) + " s"; // the log's clock, as everywhere on the page
  $("time").value = Math.round((now - first) / (last - first) * 10000);
  $("time").setAttribute("aria-valuetext", now.toFixed(3) + " seconds");
  for (const chart of charts) { chart.cursor = now; chart.draw(); }
  sheet.draw();
}
function seek(time) { now = Math.min(last, Math.max(first, time)); show(); }

const speeds = [0.1, 1, 10, 100].map((speed) => [speed, speed + "×"]);
speeds.push([Math.max((last - first) / 20, 1e-3), "all in 20 s"]);
for (const [value, label] of speeds) $("speed").add(new Option(label, value));
$("speed").selectedIndex = last - first > 20 ? 4 : 1;

function play(on) {
  playing = on ? performance.now() : null;
  $("play").textContent = on ? "Pause" : "Play";
  if (on && now >= last) now = first;
  if (on) requestAnimationFrame(frame);
}
function frame(time) {
  if (playing === null) return;
  const passed = Math.max(0, time - playing) * 1e-3;
  playing = time;
  seek(now + passed * Number($("speed").value));
  if (now >= last) play(false); else requestAnimationFrame(frame);
}
$("play").addEventListener("click", () => play(playing === null));
$("time").addEventListener("input", () => seek(first + $("time").value / 10000 * (last - first)));
window.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
  const step = (last - first) * (event.shiftKey ? 0.001 : 0.01);
  const act = {
    " ": () => play(playing === null), ArrowLeft: () => seek(now - step), ArrowRight: () => seek(now + step),
    Home: () => seek(first), End: () => seek(last),
    Enter: () => event.target.matches("tr[tabindex]") && event.target.click(),
  }[event.key];
  if (act && !(event.key === " " && event.target.tagName === "BUTTON")) { if (event.key !== "Enter") event.preventDefault(); act(); }
});
window.addEventListener("repaint", () => { layer = null; charts.forEach((chart) => chart.changed()); show(); });

function rows(table, head, list) { // each a time in us or null, and words
  const row = (cells, tag) => {
    const tr = document.createElement("tr");
    cells.forEach((text, n) => { const cell = document.createElement(tag); cell.textContent = text; if (n === 0) cell.className = "time"; tr.append(cell); });
    return tr;
  };
  table.replaceChildren(row(head, "th"), ...list.map(([time, ...words]) => {
    const tr = row([time === null ? "–" : (time * 1e-6).toFixed(6), ...words], "td");
    if (time !== null) { tr.tabIndex = 0; tr.addEventListener("click", () => seek(time * 1e-6)); }
    return tr;
  }));
}
const shown = (list, count) => count > list.length ? count + ", the first " + list.length + " shown" : String(count);
$("title").textContent = data.title;
fill($("facts"), data.facts);
const odd = [...data.anomalies, ...data.damage].sort((a, b) => (a[0] || 0) - (b[0] || 0));
$("anomalies-title").textContent = "Anomalies: " + shown(data.anomalies, data.anomaly_count) + "; damaged lines: " + shown(data.damage, data.damage_count);
rows($("anomalies"), ["time (s)", "what"], odd);
$("gaps-title").textContent = "Gaps of more than " + data.gap_after_ms + " ms: " + (data.gap_count > data.gaps.length ? data.gap_count + ", the longest " + data.gaps.length + " shown" : data.gap_count);
rows($("gaps"), ["time (s)", "silent for (s)"], data.gaps.map(([start, length]) => [start, (length * 1e-6).toFixed(3)]));
$("legend").innerHTML = [
  ["meant", 1, "desired"], ["ink", 4, "drawn"], ["differs", 4, "drawn, more than " + data.mark_mm + " mm off"], ...pens.filter((pen) => pen).map((pen) => ["pen" + pen, 4, "pen " + (pen + 1)]), ["undrawn", 2, "desired, not drawn"], ["faint", 2, "drawn later"], ["travel", 1, "pen up"],
].map(([name, width, label]) => "<span><i style='border-top-color:var(--" + name + ");border-top-width:" + width + "px'></i>" + label + "</span>").join("");
$("exactness").textContent = (data.ink ? "Too long for lines: the ink is a map of cells of " + data.ink.side_mm.toFixed(1) + " mm, each from the time of its first ink; the pen is shown within " : "Lines are shown within ") + data.way_error_mm.toFixed(3) + " mm, at every time; "
  + way.length + " points of the way are kept, and the least and greatest value of each stretch of the charts.";
seek(last);
document.body.dataset.ready = "yes";
document.body.dataset.readyMs = performance.now();
})();
