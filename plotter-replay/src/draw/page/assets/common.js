// What both pages share: the sheet and the charts, painted on canvases.
const $ = (id) => document.getElementById(id);
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const DRAWN = 1, DIFFERS = 2;

function sized(canvas) { // pixels of the screen, not of the page
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  return ratio;
}

function ticks(low, high, most) { // round places between two values
  const span = high - low;
  if (!(span > 0)) return [low];
  let step = Math.pow(10, Math.floor(Math.log10(span / most)));
  for (const by of [2, 2.5, 2]) if (span / step > most) step *= by;
  const places = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + step * 1e-6; n++) places.push(n * step);
  places.decimals = Math.min(20, Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (step / Math.pow(10, Math.floor(Math.log10(step) + 1e-9)) % 1 ? 1 : 0)));
  return places;
}

// A sheet in mm, y up. Ctrl and wheel or two fingers zoom, the mouse or two fingers move, a double click shows all of it. The wheel
// alone and one finger belong to the page, which they scroll.
class Sheet {
  constructor(canvas, paint) {
    this.canvas = canvas; this.paint = paint; this.box = null; this.view = null;
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // (fingers that spread on a touchpad come as Ctrl and wheel)
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      this.held = [event.offsetX, event.offsetY]; canvas.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { this.held = null; });
    canvas.addEventListener("pointermove", (event) => {
      if (this.held) this.held = this.move(this.held, [event.offsetX, event.offsetY]);
    });
    const fingers = ({ touches }) => { // the place between two of them, and how far apart they are
      if (touches.length !== 2) return null;
      const [a, b] = touches, { left, top } = canvas.getBoundingClientRect();
      return { at: [(a.clientX + b.clientX) / 2 - left, (a.clientY + b.clientY) / 2 - top], apart: Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) };
    };
    for (const name of ["touchstart", "touchmove", "touchend", "touchcancel"]) {
      canvas.addEventListener(name, (event) => {
        const last = this.fingers, next = this.fingers = fingers(event);
        if (!next) return;
        event.preventDefault(); // two fingers are not the page's
        if (!last) return;
        if (next.apart > 0 && last.apart > 0) this.zoom(next.apart / last.apart, ...last.at);
        this.move(last.at, next.at);
      }, { passive: false });
    }
    canvas.addEventListener("dblclick", () => { this.view = null; this.draw(); });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }
  move(from, to) { // what is at one place of the canvas comes to another
    if (this.view) {
      this.view.x -= (to[0] - from[0]) / this.scale;
      this.view.y += (to[1] - from[1]) / this.scale;
      this.draw();
    }
    return to;
  }
  zoom(by, px, py) {
    const before = this.place(px, py);
    if (!this.view) this.view = { x: this.centre[0], y: this.centre[1], zoom: 1 };
    this.view.zoom = Math.min(1e4, Math.max(0.2, this.view.zoom * by));
    this.fit();
    const after = this.place(px, py);
    this.view.x += before[0] - after[0]; this.view.y += before[1] - after[1];
    this.draw();
  }
  fit() { // scale: pixels of the page to the mm
    const [x0, y0, x1, y1] = this.box || [0, 0, 100, 70];
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    const all = Math.min((width - 40) / Math.max(x1 - x0, 0.5), (height - 56) / Math.max(y1 - y0, 0.5));
    this.scale = Math.max(all, 1e-9) * (this.view ? this.view.zoom : 1);
    this.centre = this.view ? [this.view.x, this.view.y] : [(x0 + x1) / 2, (y0 + y1) / 2];
  }
  place(px, py) {
    return [this.centre[0] + (px - this.canvas.clientWidth / 2) / this.scale,
      this.centre[1] - (py - (this.canvas.clientHeight - 16) / 2) / this.scale];
  }
  draw() {
    if (!this.canvas.clientWidth) return;
    const ratio = sized(this.canvas), context = this.canvas.getContext("2d");
    this.fit();
    const scale = this.scale * ratio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    const X = (x) => this.canvas.width / 2 + (x - this.centre[0]) * scale;
    const Y = (y) => (this.canvas.height - 16 * ratio) / 2 - (y - this.centre[1]) * scale;
    context.lineJoin = context.lineCap = "round";
    this.paint({ context, X, Y, ratio, scale });
    this.bar(context, ratio, scale);
  }
  bar(context, ratio, scale) { // how long a mm is
    let length = Math.pow(10, Math.floor(Math.log10(this.canvas.width / scale / 5)));
    for (const by of [2, 2.5]) if (length * by * scale < this.canvas.width / 5) length *= by;
    const x = 12 * ratio, y = this.canvas.height - 10 * ratio;
    context.strokeStyle = context.fillStyle = colour("quiet");
    context.lineWidth = ratio; context.setLineDash([]);
    context.beginPath();
    context.moveTo(x, y - 5 * ratio); context.lineTo(x, y); context.lineTo(x + length * scale, y); context.lineTo(x + length * scale, y - 5 * ratio);
    context.stroke();
    context.font = 12 * ratio + "px system-ui, sans-serif";
    context.textAlign = "left"; context.textBaseline = "alphabetic";
    context.fillText(+length.toPrecision(3) + " mm", x + length * scale + 7 * ratio, y);
  }
}

// Lines of a way from one point to another: one path for each state.
function strokes(way, from, to, { context, X, Y }, styles) {
  for (const [mask, value, stroke, width, dash] of styles) {
    context.strokeStyle = stroke; context.lineWidth = width; context.setLineDash(dash || []);
    context.beginPath();
    let open = false;
    for (let n = Math.max(1, from); n < to; n++) {
      if ((way.s[n] & mask) !== value) { open = false; continue; }
      if (!open) context.moveTo(X(way.x[n - 1]), Y(way.y[n - 1]));
      context.lineTo(X(way.x[n]), Y(way.y[n]));
      open = true;
    }
    context.stroke();
  }
  context.setLineDash([]);
}

function pen({ context, X, Y, ratio }, x, y, isDown) { // where the pen is: filled if it is down
  context.beginPath();
  context.arc(X(x), Y(y), 6 * ratio, 0, 2 * Math.PI);
  context.lineWidth = 2.5 * ratio;
  context.strokeStyle = context.fillStyle = colour("stop");
  if (isDown) context.fill();
  context.stroke();
}

function crosshair({ context, X, Y, ratio }, x, y) { // the next coordinate
  context.strokeStyle = colour("accent"); context.lineWidth = 1.5 * ratio;
  context.beginPath();
  context.moveTo(X(x) - 9 * ratio, Y(y)); context.lineTo(X(x) + 9 * ratio, Y(y));
  context.moveTo(X(x), Y(y) - 9 * ratio); context.lineTo(X(x), Y(y) + 9 * ratio);
  context.stroke();
}

const PENS = { target: ["setpoint", 1.2], desired: ["meant", 3.2], actual: ["ink", 1.3], error: ["differs", 1.2] };

// Curves over time. A curve is a list of [seconds, low, high], in order; null between parts.
class Chart {
  constructor(parent, label, unit, curves, seek) {
    const figure = document.createElement("section");
    figure.innerHTML = "<h2></h2><canvas style='height:150px'></canvas><div class='legend'></div>";
    figure.querySelector("h2").textContent = label + " (" + unit + ")";
    this.value = document.createElement("output");
    this.value.className = "quiet";
    figure.querySelector("h2").append(" ", this.value);
    this.canvas = figure.querySelector("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label + " over time");
    const legend = figure.querySelector(".legend");
    for (const curve of curves) {
      const entry = document.createElement("span"), line = document.createElement("i");
      line.style.borderTopColor = "var(--" + PENS[curve.role][0] + ")";
      line.style.borderTopWidth = Math.max(2, PENS[curve.role][1]) + "px";
      entry.append(line, curve.label);
      legend.append(entry);
    }
    parent.append(figure);
    this.unit = unit; this.curves = curves; this.cursor = null; this.bands = []; this.span = [0, 1];
    if (seek) {
      const to = (event) => {
        const share = (event.offsetX - 64) / Math.max(1, this.canvas.clientWidth - 74);
        seek(this.span[0] + Math.min(1, Math.max(0, share)) * (this.span[1] - this.span[0]));
      };
      this.canvas.addEventListener("pointerdown", (event) => { this.canvas.setPointerCapture(event.pointerId); to(event); });
      this.canvas.addEventListener("pointermove", (event) => { if (event.buttons) to(event); });
    }
    new ResizeObserver(() => { this.still = null; this.draw(); }).observe(this.canvas);
  }
  changed() { this.still = null; }
  draw() { // the curves are painted once, the cursor each time
    if (!this.canvas.clientWidth) return;
    const ratio = sized(this.canvas), { width, height } = this.canvas;
    const context = this.canvas.getContext("2d");
    if (!this.still) {
      this.still = document.createElement("canvas");
      this.still.width = width; this.still.height = height;
      this.paint(this.still.getContext("2d"), width, height, ratio);
    }
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still, 0, 0);
    if (this.cursor !== null) {
      const x = this.X(this.cursor);
      context.strokeStyle = colour("stop"); context.lineWidth = ratio;
      context.beginPath(); context.moveTo(x, 4 * ratio); context.lineTo(x, height - 20 * ratio); context.stroke();
    }
  }
  paint(context, width, height, ratio) {
    let low = Infinity, high = -Infinity;
    for (const { points } of this.curves) for (const point of points) if (point && point[0] >= this.span[0]) { low = Math.min(low, point[1]); high = Math.max(high, point[2]); }
    if (!(low <= high)) { low = 0; high = 1; }
    if (this.curves.some(({ run }) => run === "bars")) low = Math.min(low, 0);
    if (high - low < 1e-6) { low -= 0.5; high += 0.5; }
    const margin = (high - low) * 0.06; low -= margin; high += margin;
    const left = 64 * ratio, right = width - 10 * ratio, top = 4 * ratio, bottom = height - 20 * ratio;
    const [from, to] = this.span, X = (s) => left + (s - from) / Math.max(to - from, 1e-9) * (right - left);
    const Y = (v) => bottom - (v - low) / (high - low) * (bottom - top);
    this.X = X;
    context.font = 11.5 * ratio + "px system-ui, sans-serif";
    context.lineWidth = ratio;
    context.fillStyle = colour("band");
    for (const [start, end] of this.bands) context.fillRect(X(start), top, Math.max(ratio, X(end) - X(start)), bottom - top);
    context.fillStyle = colour("quiet"); context.strokeStyle = colour("grid");
    context.textAlign = "right"; context.textBaseline = "middle";
    const levels = ticks(low, high, 5);
    for (const level of levels) {
      context.beginPath(); context.moveTo(left, Y(level)); context.lineTo(right, Y(level)); context.stroke();
      context.fillText(level.toFixed(levels.decimals), left - 6 * ratio, Y(level));
    }
    context.textBaseline = "alphabetic"; context.textAlign = "center";
    const times = ticks(from, to, 9);
    for (const time of times) {
      context.beginPath(); context.moveTo(X(time), top); context.lineTo(X(time), bottom); context.stroke();
      context.fillText(time.toFixed(times.decimals), X(time), height - 5 * ratio);
    }
    context.textAlign = "right"; context.fillText("s", width - 1, height - 5 * ratio);
    context.strokeStyle = colour("line");
    context.strokeRect(left, top, right - left, bottom - top);
    context.save();
    context.beginPath(); context.rect(left, top, right - left, bottom - top); context.clip();
    context.lineJoin = "round";
    for (const { role, run, points } of this.curves) {
      context.strokeStyle = colour(PENS[role][0]); context.lineWidth = PENS[role][1] * ratio;
      context.beginPath();
      let last = null;
      for (const point of points) {
        if (!point) { last = null; continue; }
        const x = X(point[0]);
        let y0 = Y(point[1]), y1 = Y(point[2]);
        if (last !== null && Math.abs(y1 - last) < Math.abs(y0 - last)) [y0, y1] = [y1, y0]; // downhill
        if (last === null) context.moveTo(x, y0);
        else if (run === "steps") { context.lineTo(x, last); context.lineTo(x, y0); }
        else context.lineTo(x, y0);
        if (y1 !== y0) context.lineTo(x, y1);
        last = y1;
      }
      if (run === "steps" && last !== null) context.lineTo(right, last);
      context.stroke();
    }
    context.restore();
  }
}

function fill(list, facts) { // names and values
  list.replaceChildren(...facts.flatMap(([name, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name; dd.textContent = value;
    return [dt, dd];
  }));
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => window.dispatchEvent(new Event("repaint")));
