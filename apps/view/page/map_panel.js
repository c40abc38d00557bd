// The whole drive from above: the camera's path, the true one, that of another run. A click goes to the frame there.

const kMargin = 16;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Ground points of a path given as x, y, z, x, y, z, ...
function ground(path) {
  const points = [];
  for (let i = 0; i + 2 < path.length; i += 3) points.push([path[i], path[i + 2]]);
  return points;
}

export class MapPanel {
  constructor(canvas, onGo) {
    this.canvas = canvas;
    this.paths = [];
    canvas.addEventListener("click", (event) => {
      const frame = this.frameAt(event);
      if (frame !== null) onGo(frame);
    });
    this.still = document.createElement("canvas");  // all that does not change with the frame
    new ResizeObserver(() => this.drawStill()).observe(canvas);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.drawStill());
  }

  // `paths` have a name, color, points and first frame; the run's own comes first. `marks` are frames to point out.
  set(paths, marks) {
    this.paths = paths.map((path) => ({ ...path, points: ground(path.path) }));
    this.marks = marks;
    this.drawStill();
  }

  show(frame, truth_on) {
    this.frame = frame;
    if (truth_on !== this.truth_on) {
      this.truth_on = truth_on;
      this.drawStill();
    }
    this.draw();
  }

  // The longer side lies across: as on a map, or with the first camera's view to the right.
  layOut(width, height) {
    const all = this.paths.flatMap(({ points }) => points);
    const low = [0, 1].map((i) => all.reduce((a, p) => Math.min(a, p[i]), Infinity));
    const high = [0, 1].map((i) => all.reduce((a, p) => Math.max(a, p[i]), -Infinity));
    const middle = [0, 1].map((i) => (low[i] + high[i]) / 2), size = [0, 1].map((i) => Math.max(high[i] - low[i], 5));
    const turned = size[1] > size[0], [across, up] = turned ? [size[1], size[0]] : size;
    this.scale = Math.min((width - 2 * kMargin) / across, (height - 2 * kMargin) / up);
    this.at = ([x, z]) => (turned ? [width / 2 + this.scale * (z - middle[1]), height / 2 + this.scale * (x - middle[0])]
      : [width / 2 + this.scale * (x - middle[0]), height / 2 - this.scale * (z - middle[1])]);
  }

  frameAt(event) {
    const own = this.paths[0];
    if (!own || !this.at) return null;
    const box = this.canvas.getBoundingClientRect(), u = event.clientX - box.left, v = event.clientY - box.top;
    let best = Infinity, frame = null;
    own.points.forEach((point, i) => {
      const [x, y] = this.at(point), away = Math.hypot(x - u, y - v);
      if (away < best) [best, frame] = [away, own.first_frame + i];
    });
    return frame;
  }

  drawStill() {
    const { canvas, still } = this, width = canvas.clientWidth, height = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
    if (!width || !height || !this.paths.some(({ points }) => points.length > 0)) return;
    still.width = Math.round(width * ratio);
    still.height = Math.round(height * ratio);
    this.context = still.getContext("2d");
    this.context.scale(ratio, ratio);
    this.layOut(width, height);
    for (const path of [...this.paths].reverse()) if (!path.of_truth || this.truth_on) this.drawPath(path);
    for (const frame of this.marks ?? []) this.drawMark(frame);
    this.drawScale(height);
    this.draw();
  }

  draw() {
    const { canvas, still } = this;
    if (!this.at) return;
    Object.assign(canvas, { width: still.width, height: still.height });
    const context = this.context = canvas.getContext("2d");
    context.drawImage(still, 0, 0);
    context.scale(window.devicePixelRatio || 1, window.devicePixelRatio || 1);
    this.drawHere();
  }

  drawPath({ points, color, dash = [], wide = 2 }) {
    const { context } = this;
    context.strokeStyle = css(color);
    context.lineWidth = wide;
    context.lineJoin = "round";
    context.setLineDash(dash);
    context.beginPath();
    for (const point of points) context.lineTo(...this.at(point));
    context.stroke();
    context.setLineDash([]);
  }

  point(frame) { return this.paths[0].points[frame - this.paths[0].first_frame]; }

  drawMark(frame) {
    const point = this.point(frame), { context } = this;
    if (!point) return;
    const [x, y] = this.at(point);
    context.fillStyle = css("--bad");
    context.beginPath();
    for (const [dx, dy] of [[0, -5], [5, 0], [0, 5], [-5, 0]]) context.lineTo(x + dx, y + dy);
    context.fill();
  }

  drawHere() {
    const point = this.frame && this.point(this.frame.frame), { context } = this;
    if (!point) return;
    const [x, y] = this.at(point);
    context.beginPath();
    context.arc(x, y, 6, 0, 7);
    context.fillStyle = css("--accent");
    context.fill();
    context.strokeStyle = css("--card");
    context.lineWidth = 2;
    context.stroke();
  }

  drawScale(height) {
    const { context } = this, wanted = 70 / this.scale, power = 10 ** Math.floor(Math.log10(wanted));
    const length_m = [5, 2, 1].map((n) => n * power).find((n) => n <= wanted) ?? power, end = 10 + length_m * this.scale;
    context.strokeStyle = context.fillStyle = css("--dim");
    context.lineWidth = 1.5;
    context.beginPath();
    for (const point of [[10, height - 12], [10, height - 8], [end, height - 8], [end, height - 12]]) context.lineTo(...point);
    context.stroke();
    context.font = "11px system-ui, sans-serif";
    context.fillText(`${length_m} m`, end + 6, height - 6);
  }
}
