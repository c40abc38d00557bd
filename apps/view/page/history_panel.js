// Speed, acceleration, yaw rate and distance of one object over time, each with a band of one standard deviation. While
// none is chosen they are the camera's, whose acceleration is not known. A dot marks the shown frame.

const kDegrees = 180 / Math.PI;
const kQuantities = {
  speed: { value: (o) => o.speed, sigma: (o) => o.speed_sigma, digits: 2, unit: "m/s" },
  acceleration: { value: (o) => o.acceleration, sigma: (o) => o.acceleration_sigma, digits: 2, unit: "m/s\u00b2" },
  yaw: { value: (o) => o.yaw_rate * kDegrees, sigma: (o) => (o.yaw_rate_sigma == null ? null : o.yaw_rate_sigma * kDegrees), digits: 1, unit: "deg/s" },
  distance: { value: (o) => o.distance, sigma: (o) => o.distance_sigma, digits: 2, unit: "m" },
};
const kAround = 2;  // frames before and after, over which the camera's speed is taken

// The camera as if it were an object: its speed over the ground, its yaw rate to the left, its distance so far.
// `driven` is that distance in the first of these frames.
function cameraRows(frames, driven) {
  return frames.flatMap((frame, i) => {
    if (i > 0) driven += Math.hypot(...[3, 7, 11].map((k) => frame.T[k] - frames[i - 1].T[k]));
    const a = frames[Math.max(0, i - kAround)], b = frames[Math.min(frames.length - 1, i + kAround)], dt = b.time - a.time;
    if (!(dt > 0)) return [];
    const turn = Math.atan2(a.T[2], a.T[10]) - Math.atan2(b.T[2], b.T[10]);
    return [{ frame: frame.frame, time: frame.time, object: { speed: Math.hypot(...[3, 7, 11].map((k) => b.T[k] - a.T[k])) / dt,
      yaw_rate: Math.atan2(Math.sin(turn), Math.cos(turn)) / dt, distance: driven } }];
  });
}

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class HistoryPanel {
  constructor() {
    this.element = (id) => document.getElementById(id);
    this.dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.paint());
  }

  // Made when first needed: a hidden canvas has no size.
  charts() {
    this.made ??= Object.fromEntries(Object.keys(kQuantities).map((name) => [name, new Chart(this.element(`plot-${name}`), {
      type: "line",
      data: { datasets: [{ pointRadius: 0, borderWidth: 0 }, { pointRadius: 0, borderWidth: 0, fill: "-1" }, { pointRadius: 0, borderWidth: 2 }, { pointRadius: 4, borderWidth: 2, showLine: false }] },
      options: {
        animation: false, parsing: false, normalized: true, maintainAspectRatio: false, events: [],
        plugins: { legend: { display: false }, tooltip: { enabled: false } },
        scales: { x: { type: "linear", display: name === "distance", grid: { display: false }, ticks: { maxTicksLimit: 6, maxRotation: 0, callback: (s) => `${+s.toFixed(1)} s` } },
          y: { ticks: { maxTicksLimit: 3 }, afterFit: (axis) => { axis.width = 40; } } },
      },
    })]));
    return this.made;
  }

  paint() {
    if (!this.made) return;
    for (const chart of Object.values(this.made)) {
      for (const axis of ["x", "y"]) chart.options.scales[axis].ticks.color = css("--dim");
      chart.options.scales.y.grid = { color: css("--line"), drawBorder: false };
      chart.data.datasets[1].backgroundColor = `${this.color}44`;
      chart.data.datasets[3].borderColor = css("--ink");
      chart.data.datasets[3].backgroundColor = css("--card");
      chart.data.datasets[2].borderColor = this.dark.matches || this.of_camera ? this.color : `color-mix(in srgb, ${this.color} 74%, black)`;
      chart.update();
    }
  }

  // `frames` around the shown one, or up to it, and the camera's distance so far in the first of them.
  show(id, shown, frames, driven) {
    const rows = id === null ? cameraRows(frames, driven) : frames.flatMap(({ frame, time, objects }) => {
      const object = objects.find((o) => o.id === id);
      return object ? [{ frame, time, object }] : [];
    });
    const now = rows.find(({ frame }) => frame === shown.frame) ?? null;
    const known = rows.length > 0;
    this.element("history").hidden = !known;
    this.element("history-hint").hidden = known;
    this.element("history-hint").textContent = id === null ? "The camera has not moved yet." : `#${id} is not seen around this frame.`;
    this.element("history-title").textContent = id === null ? "History of the camera" : `History of #${id}`;
    this.element("history-close").hidden = id === null;
    this.element("distance-title").textContent = id === null ? "Driven" : "Distance";
    if (!known) return;
    this.color = id === null ? css("--accent") : rows[rows.length - 1].object.color;
    this.of_camera = id === null;
    const charts = this.charts();
    this.element("acceleration").hidden = rows.every(({ object }) => object.acceleration == null);
    for (const [name, chart] of Object.entries(charts)) this.fill(name, chart, rows, now);
    this.paint();
  }

  fill(name, chart, rows, now) {
    const { value, sigma, digits, unit } = kQuantities[name];
    const points = (sign) => rows.filter(({ object }) => value(object) != null)
      .map(({ time, object }) => ({ x: time, y: value(object) + sign * (sigma(object) ?? 0) }));
    [-1, 1, 0].forEach((sign, i) => { chart.data.datasets[i].data = points(sign); });
    Object.assign(chart.options.scales.x, { min: rows[0].time, max: Math.max(rows[rows.length - 1].time, rows[0].time + 1) });
    const shown = now === null ? null : value(now.object);
    chart.data.datasets[3].data = shown == null ? [] : [{ x: now.time, y: shown }];
    const text = (number) => number.toFixed(digits).replace(/^-(0(\.0+)?)$/, "$1");
    this.element(`now-${name}`).textContent = shown == null ? "" :
      `${text(shown)}${sigma(now.object) == null ? "" : ` \u00b1 ${text(sigma(now.object))}`} ${unit}`;
  }
}
