// Time per stage, latency, counts and queues.

const kRecent = 300;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function quantile(sorted, share) { return sorted.length > 0 ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : null; }

function facts(element, entries) {
  if (element.children.length !== entries.length)
    element.replaceChildren(...entries.map(() => {
      const group = document.createElement("div");
      group.append(document.createElement("dt"), document.createElement("dd"));
      return group;
    }));
  entries.forEach(([name, value], i) => {
    element.children[i].firstChild.textContent = name;
    element.children[i].lastChild.textContent = value;
  });
}

// Rows of name, bar and value; made once, filled often.
function bars(element, entries) {
  if (element.children.length !== 3 * entries.length)
    element.replaceChildren(...entries.flatMap(() => {
      const [name, bar, value] = ["span", "div", "span"].map((tag) => document.createElement(tag));
      name.className = "name";
      value.className = "value";
      bar.className = "bar";
      bar.append(document.createElement("i"), document.createElement("b"));
      return [name, bar, value];
    }));
  entries.forEach(({ name, share, mark, text }, i) => {
    const [label, bar, value] = [0, 1, 2].map((k) => element.children[3 * i + k]);
    label.textContent = name;
    bar.firstChild.style.width = `${100 * Math.min(share, 1)}%`;
    bar.lastChild.style.left = mark === undefined ? "-4px" : `calc(${100 * Math.min(mark, 1)}% - 2px)`;
    value.textContent = text;
  });
}

export class TimingPanel {
  // `overall` has the percentiles of all frames of a run that is over (docs/view.md).
  constructor(info, overall) {
    this.info = info;
    this.overall = overall;
    this.element = (id) => document.getElementById(id);
    this.value = ({ latency_ms, processing_ms }) => (info.paced ? latency_ms : processing_ms);
    if (!info.paced) this.element("latency-title").textContent = "Processing of a pair";
    this.element("latency-note").hidden = info.paced;
    if (info.recorded) this.element("recent-title").firstChild.textContent = "Frames around";
    this.chart = new Chart(this.element("plot-latency"), {
      type: "bar",
      data: { labels: [], datasets: [{ data: [], barPercentage: 1, categoryPercentage: 0.92, borderRadius: 2 }] },
      options: {
        animation: false, maintainAspectRatio: false, plugins: { legend: { display: false }, tooltip: { callbacks: {
          title: ([item]) => `up to ${item.label} ms`, label: (item) => `${item.raw} frames` } } },
        scales: { x: { grid: { display: false }, ticks: { maxRotation: 0, autoSkipPadding: 8 } }, y: { beginAtZero: true, ticks: { maxTicksLimit: 4, precision: 0 } } },
      },
    });
    this.recent = new Chart(this.element("plot-recent"), {
      type: "line",
      data: { datasets: [{ data: [], pointRadius: 0, borderWidth: 1.5, fill: "origin" }] },
      options: {
        animation: false, parsing: false, maintainAspectRatio: false, events: [], plugins: { legend: { display: false } },
        scales: { x: { type: "linear", grid: { display: false }, ticks: { maxTicksLimit: 7, maxRotation: 0, precision: 0 } }, y: { beginAtZero: true, ticks: { maxTicksLimit: 4 } } },
      },
    });
    this.paint();
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.paint(); this.chart.update(); this.recent.update(); });
  }

  paint() {
    this.chart.data.datasets[0].backgroundColor = css("--bar");
    Object.assign(this.recent.data.datasets[0], { borderColor: css("--bar"), backgroundColor: `${css("--bar")}33` });
    for (const chart of [this.chart, this.recent]) {
      for (const axis of ["x", "y"]) chart.options.scales[axis].ticks.color = css("--dim");
      chart.options.scales.y.grid = { color: css("--line"), drawBorder: false };
    }
  }

  // `past` are the frames for the percentiles of a running run, `around` those that are drawn.
  showFrame(frame, past, around) {
    this.showRecent(around);
    const text = (value) => (value === null || value === undefined ? "\u2013" : value.toFixed(1));
    const of = this.overall ?? this.recentPercentiles(past);
    facts(this.element("percentiles"), [["this frame", text(frame.timing && this.value(frame.timing))],
      ...["p50", "p95", "p99", "max"].map((name) => [name, text(of[name])])]);
    this.element("percentiles-of").textContent = this.overall ? `percentiles of all ${of.frames} frames` : `percentiles of the last ${of.frames} frames`;
    const high = of.stages_p95, now = frame.timing?.stages_ms ?? [], scale = Math.max(1, ...high) * 1.25;
    bars(this.element("stages"), this.info.stages.map((name, i) =>
      ({ name, share: (now[i] ?? 0) / scale, mark: high[i] / scale, text: text(now[i]) })));
  }

  // Percentiles of a running run.
  recentPercentiles(past) {
    const timed = past.slice(-kRecent).map(({ timing }) => timing).filter(Boolean);
    const sorted = timed.map(this.value).sort((a, b) => a - b);
    return { frames: timed.length, p50: quantile(sorted, 0.5), p95: quantile(sorted, 0.95), p99: quantile(sorted, 0.99), max: sorted[sorted.length - 1],
      stages_p95: this.info.stages.map((_, i) => quantile(timed.map(({ stages_ms }) => stages_ms[i]).sort((a, b) => a - b), 0.95) ?? 0) };
  }

  showRecent(around) {
    this.recent.data.datasets[0].data = around.filter(({ timing }) => timing).map(({ frame, timing }) => ({ x: frame, y: this.value(timing) }));
    const scale = this.recent.options.scales.x;
    scale.min = around[0]?.frame;
    scale.max = around[around.length - 1]?.frame;
    const now = performance.now();
    if (now - (this.recent_drawn ?? 0) < 200) return;
    this.recent_drawn = now;
    this.recent.update();
  }

  showRun(run) {
    if (run.received === undefined) return;
    facts(this.element("counts"), [["received", run.received], ["processed", run.processed], ["dropped", run.dropped],
      ["rejected", run.rejected], ["lost", run.lost], ...(this.info.recorded ? [] : [["viewers", run.viewers]])]);
    const queues = run.queues ?? [];
    this.element("queues-title").hidden = queues.length === 0;
    bars(this.element("queues"), queues.map(({ name, waiting, bound }) =>
      ({ name: name.replace(">", " \u2192 "), share: waiting / bound, text: `${waiting} / ${bound}` })));
    this.showHistogram((this.info.paced ? run.latency_counts : run.processing_counts) ?? []);
  }

  // The buckets without the empty ends.
  showHistogram(counts) {
    const first = Math.max(0, counts.findIndex((count) => count > 0) - 1);
    let end = counts.length;
    while (end > 1 && counts[end - 1] === 0) --end;
    end = Math.min(counts.length, end + 1);
    const bounds = [...this.info.latency_bounds_ms.map(String), "more"];
    this.chart.data.labels = bounds.slice(first, end);
    this.chart.data.datasets[0].data = counts.slice(first, end);
    const now = performance.now();
    if (now - (this.drawn ?? 0) < 240) return;
    this.drawn = now;
    this.chart.update();
  }
}
