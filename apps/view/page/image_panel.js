// The left image with outlines, cuboids and tags.

const kNearest = 1.5;

function project(p, camera) {
  return [camera.fx * p[0] / p[2] + camera.cx, camera.fy * p[1] / p[2] + camera.cy];
}

function toCamera(T, p) {
  const d = [p[0] - T[3], p[1] - T[7], p[2] - T[11]];
  return [0, 1, 2].map((i) => T[i] * d[0] + T[4 + i] * d[1] + T[8 + i] * d[2]);
}

function toWorld(T, p) { return [0, 4, 8].map((i) => T[i] * p[0] + T[i + 1] * p[1] + T[i + 2] * p[2] + T[i + 3]); }

export function cuboidCorners(object) {
  const { center, size } = object.cuboid;
  return [...Array(8).keys()].map((i) => toWorld(object.T,
    [0, 1, 2].map((axis) => center[axis] + (i >> axis & 1 ? 0.5 : -0.5) * size[axis])));
}

// Edges as pairs of corners, each with a flag that the cuboid itself hides it.
function edges(object, frame) {
  const eye = frame.T.filter((_, i) => i % 4 === 3);
  const T = object.T, { center, size } = object.cuboid;
  const d = [eye[0] - T[3], eye[1] - T[7], eye[2] - T[11]];
  const local = [0, 1, 2].map((i) => (T[i] * d[0] + T[4 + i] * d[1] + T[8 + i] * d[2] - center[i]) / size[i]);
  const seen = (axis, upper) => (upper ? local[axis] > 0.5 : local[axis] < -0.5);
  const list = [];
  for (let from = 0; from < 8; ++from) {
    for (let axis = 0; axis < 3; ++axis) {
      const to = from | 1 << axis;
      if (to === from) continue;
      const a = (axis + 1) % 3, b = (axis + 2) % 3;
      list.push([from, to, seen(a, from >> a & 1) || seen(b, from >> b & 1)]);
    }
  }
  return list;
}

function line(a, b, camera) {
  if (a[2] > b[2]) [a, b] = [b, a];
  if (b[2] < kNearest) return null;
  if (a[2] < kNearest) {
    const t = (kNearest - a[2]) / (b[2] - a[2]);
    a = a.map((value, i) => value + t * (b[i] - value));
  }
  return [project(a, camera), project(b, camera)];
}

export class ImagePanel {
  constructor(canvas, onChoose) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    canvas.addEventListener("click", (event) => onChoose(this.objectAt(event)));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  setCamera(camera) {
    this.camera = camera;
    this.canvas.style.aspectRatio = `${camera.width} / ${camera.height}`;
  }

  show(frame, image, chosen, truth_on) {
    this.truth_on = truth_on;
    this.frame = frame;
    this.image = image;
    this.chosen = chosen;
    this.draw();
  }

  objectAt(event) {
    if (!this.frame) return null;
    const box = this.canvas.getBoundingClientRect(), scale = this.camera.width / box.width;
    const u = (event.clientX - box.left) * scale, v = (event.clientY - box.top) * scale;
    const inside = this.frame.objects.filter(({ box: b }) => u >= b[0] && u <= b[2] && v >= b[1] && v <= b[3]);
    inside.sort((a, b) => (a.distance ?? 1e9) - (b.distance ?? 1e9));
    return inside.length > 0 ? inside[0].id : null;
  }

  draw() {
    if (!this.camera || !this.frame) return;
    const { canvas, context, camera } = this;
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = width * camera.height / camera.width;
    if (width === 0) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const scale = width / camera.width;
    context.setTransform(ratio * scale, 0, 0, ratio * scale, 0, 0);
    if (this.image) context.drawImage(this.image, 0, 0, camera.width, camera.height);
    const px = 1 / scale;
    context.lineJoin = "round";
    const objects = [...this.frame.objects].sort((a, b) => (b.distance ?? 0) - (a.distance ?? 0));
    for (const object of objects) this.drawOutline(object, px);
    if (this.truth_on) for (const object of this.frame.truth?.objects ?? []) this.drawTruth(object, px);
    for (const object of objects) this.drawCuboid(object, px);
    this.drawPoints(px);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawTags(objects.reverse(), scale, width, height);
  }

  drawOutline(object, px) {
    const outline = (this.frame.outlines ?? []).find(({ id }) => id === object.id);
    const context = this.context;
    for (const corners of outline?.polygons ?? []) {
      context.beginPath();
      for (let i = 0; i < corners.length; i += 2) context.lineTo(corners[i] + 0.5, corners[i + 1] + 0.5);
      context.closePath();
      context.fillStyle = object.color;
      context.globalAlpha = 0.3;
      context.fill();
      context.globalAlpha = 0.9;
      context.strokeStyle = object.color;
      context.lineWidth = 1.2 * px;
      context.stroke();
      context.globalAlpha = 1;
    }
  }

  drawCuboid(object, px) {
    const { context } = this;
    context.strokeStyle = object.color;
    const wide = (object.id === this.chosen ? 3 : 1.7) * px;
    context.setLineDash(object.state === "predicted" ? [6 * px, 4 * px] : []);
    if (!object.cuboid) {
      const [left, top, right, bottom] = object.box;
      context.lineWidth = wide;
      context.strokeRect(left, top, right - left, bottom - top);
    } else {
      this.strokeEdges(object, wide, 1);
    }
    context.setLineDash([]);
  }

  strokeEdges(object, wide, opacity) {
    const { context, camera } = this;
    const corners = cuboidCorners(object).map((corner) => toCamera(this.frame.T, corner));
    for (const [from, to, seen] of edges(object, this.frame)) {
      const ends = line(corners[from], corners[to], camera);
      if (!ends) continue;
      context.globalAlpha = opacity * (seen ? 1 : 0.45);
      context.lineWidth = seen ? wide : 0.6 * wide;
      context.beginPath();
      context.moveTo(...ends[0]);
      context.lineTo(...ends[1]);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  // A labeled object, dashed in white on black, so that it is visible on any ground; standing ones are fainter.
  drawTruth(object, px) {
    const { context } = this, opacity = object.moving ? 1 : 0.45;
    context.strokeStyle = "#0d1014";
    this.strokeEdges(object, 2.6 * px, 0.6 * opacity);
    context.strokeStyle = "#f5f5f5";
    context.setLineDash([5 * px, 4 * px]);
    this.strokeEdges(object, 1.3 * px, opacity);
    context.setLineDash([]);
  }

  drawPoints(px) {
    const context = this.context;
    const colors = new Map(this.frame.objects.map(({ id, color }) => [id, color]));
    for (const [id, u, v] of this.frame.points ?? []) {
      context.beginPath();
      context.arc(u, v, 1.6 * px, 0, 7);
      context.fillStyle = "rgba(10, 14, 20, .7)";
      context.fill();
      context.beginPath();
      context.arc(u, v, 1 * px, 0, 7);
      context.fillStyle = colors.get(id) ?? "#fff";
      context.fill();
    }
  }

  // Nearest first; a tag that finds no free place above its object goes higher, then below, then is left out.
  drawTags(objects, scale, width, height) {
    const context = this.context, narrow = width < 620, taken = [];
    context.font = `${narrow ? 10.5 : 12}px system-ui, "DejaVu Sans", sans-serif`;
    context.textBaseline = "middle";
    const tall = narrow ? 15 : 18;
    for (const object of objects) {
      const speed = `${object.speed.toFixed(1)} \u00b1 ${object.speed_sigma.toFixed(1)}`;
      const text = narrow ? `${object.id}  ${object.speed.toFixed(1)}` : `#${object.id}  ${speed} m/s`;
      const wide = context.measureText(text).width + 13;
      const [left, top, right, bottom] = object.box.map((value) => value * scale);
      if (right < 0 || left > width) continue;
      const x = Math.min(Math.max(0.5 * (left + right - wide), 2), width - wide - 2);
      const heights = [0, 1, 2, 3].map((i) => top - 3 - tall - i * (tall + 2)).concat([bottom + 3, bottom + tall + 5]);
      const y = heights.find((at) => at >= 1 && at + tall < height &&
        !taken.some((b) => x < b[0] + b[2] && b[0] < x + wide && at < b[1] + tall + 1 && b[1] < at + tall + 1));
      if (y === undefined) continue;
      taken.push([x, y, wide]);
      context.fillStyle = "rgba(13, 16, 20, .84)";
      context.fillRect(x, y, wide, tall);
      context.fillStyle = object.color;
      context.fillRect(x, y, 3, tall);
      context.fillStyle = object.id === this.chosen ? "#ffffff" : "#e7ebf0";
      context.fillText(text, x + 8, y + tall / 2 + 0.5);
    }
  }
}
