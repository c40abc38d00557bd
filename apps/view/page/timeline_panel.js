// The timeline below the slider: frames that are not good, and errors and times over the drive. A click goes there.

const kMargin = 8;  // half of the slider's thumb, so that both are in line
const kText = 15;   // height of a curve's name and value, above it
const kStatus = { degraded: "degraded", lost: "lost", rejected: "image rejected", dropped: "dropped" };
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const element = (id) => document.getElementById(id);

// Position of a frame between the first and the last, from 0 to 1.
const share = (frame, first, last) => (last > first ? (frame - first) / (last - first) : 0);

function span(mark) {
  const frames = mark.from === mark.to ? `frame ${mark.from}` : `frames ${mark.from} to ${mark.to}`;
  return `${frames}: ${kStatus[mark.status] ?? mark.status}${mark.cause === "none" ? "" : `, ${mark.cause.replaceAll("_", " ")}`}`;
}

export class TimelinePanel {
  constructor(onGo) {
    this.onGo = onGo;
    this.curves = [];
    this.range = [0, 0];
    const strip = element("strip");
    const go = (event) => this.onGo(this.frameAt(event), event.type === "pointerdown");
    strip.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      strip.setPointerCapture(event.pointerId);
      go(event);
    });
    strip.addEventListener("pointermove", (event) => { if (strip.hasPointerCapture(event.pointerId)) go(event); });
    new ResizeObserver(() => this.draw()).observe(strip);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  frameAt(event) {
    const box = element("strip").getBoundingClientRect(), [first, last] = this.range;
    const at = (event.clientX - box.left - kMargin) / Math.max(1, box.width - 2 * kMargin);
    return Math.round(first + Math.min(Math.max(at, 0), 1) * (last - first));
  }

  // `curves` have a name, unit, digits, and lines of a color and a value per frame from `first_frame` on.
  setOverview(marks, curves, [first, last]) {
    this.range = [first, last];
    this.setMarks(marks);
    if (curves.length !== this.curves.length || curves.some(({ name }, i) => this.curves[i].name !== name))
      element("curves").replaceChildren(...curves.map(({ name }) => this.makeCurve(name)));
    this.curves = curves;
    this.draw();
  }

  setMarks(marks) {
    const [first, last] = this.range;
    element("marks").replaceChildren(...marks.map((mark) => {
      const bar = document.createElement("i");
      bar.className = `mark ${mark.status}`;
      bar.title = span(mark);
      bar.style.left = `${100 * share(mark.from, first, last)}%`;
      bar.style.width = `${100 * (mark.to - mark.from) / Math.max(1, last - first)}%`;
      return bar;
    }));
    const counts = new Map();
    for (const { status, from, to } of marks) counts.set(status, (counts.get(status) ?? 0) + to - from + 1);
    element("marks-legend").replaceChildren(...(counts.size === 0 ? ["All frames tracked"] : [...counts].map(([status, count]) => {
      const entry = document.createElement("span");
      entry.className = `mark-key ${status}`;
      entry.textContent = `${count} ${kStatus[status] ?? status}`;
      return entry;
    })));
  }

  makeCurve(name) {
    const box = document.createElement("div"), canvas = document.createElement("canvas"), label = document.createElement("span"),
      value = document.createElement("output");
    box.className = "curve";
    box.dataset.name = name;
    label.textContent = name;
    canvas.setAttribute("aria-hidden", "true");
    value.setAttribute("aria-label", name);
    box.append(canvas, label, value);
    return box;
  }

  draw() {
    this.curves.forEach((curve, i) => this.drawCurve(curve, element("curves").children[i]?.querySelector("canvas")));
  }

  drawCurve(curve, canvas) {
    const width = canvas?.clientWidth, height = canvas?.clientHeight, ratio = window.devicePixelRatio || 1;
    if (!width || !height) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const all = curve.lines.flatMap(({ values }) => values.filter((value) => value !== null));
    curve.high = all.reduce((a, b) => Math.max(a, b), 0);
    context.strokeStyle = css("--line");
    context.strokeRect(-1, height - 0.5, width + 2, 2);
    for (const line of curve.lines) this.drawLine(context, line, width - 2 * kMargin, height, curve.high || 1);
  }

  // Takes the largest value in each column of pixels, so that no peak is lost.
  drawLine(context, { values, first_frame, color, dash = [] }, width, height, high) {
    const [first, last] = this.range, columns = new Map();
    values.forEach((value, i) => {
      if (value === null) return;
      const x = Math.round(kMargin + width * share(first_frame + i, first, last));
      columns.set(x, Math.max(columns.get(x) ?? 0, value));
    });
    const step = Math.max(1.5, 1.5 * width / Math.max(1, last - first));
    context.strokeStyle = css(color);
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    context.setLineDash(dash);
    context.beginPath();
    let before = null;
    for (const [x, value] of [...columns].sort((a, b) => a[0] - b[0])) {
      const y = height - 1.5 - (height - kText - 3) * value / high;
      if (before === null || x - before > step) context.moveTo(x - 0.5, y);
      context.lineTo(x, y);
      before = x;
    }
    context.stroke();
  }

  show(frame) {
    const [first, last] = this.range;
    element("cursor").style.left = `calc(${kMargin}px + (100% - ${2 * kMargin}px) * ${share(frame, first, last)})`;
    this.curves.forEach(({ lines, unit, digits, high }, i) => {
      const texts = lines.map(({ values, first_frame }) => values[frame - first_frame]).map((value) =>
        (value === null || value === undefined ? "\u2013" : value.toFixed(digits)));
      element("curves").children[i].lastChild.textContent = `${texts.join(" | ")} ${unit}  (max ${(high ?? 0).toFixed(digits)})`;
    });
  }
}
