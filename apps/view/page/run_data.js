// The server's data (docs/view.md): the run, its frames as far as they are kept here, and the shown one.
import { takeToken } from "/frame_link.js";

const kKept = 4000;
const kChunk = 600;
const kDetails = 60;

async function json(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error((await answer.text()).trim() || answer.statusText);
  return answer.json();
}

// Another run for comparison; its frames are loaded on demand.
class OtherRun {
  constructor() { this.details = new Map(); }

  async start() {
    this.info = await json("/against/run.json");
    this.overview = await json("/against/overview.json");
  }

  async frame(number) {
    if (number < this.info.first_frame || number >= this.info.end_frame) return null;
    if (!this.details.has(number)) {
      this.details.set(number, await json(`/against/frame/${number}.json`).catch(() => null));
      for (const old of this.details.keys()) if (this.details.size > kDetails) this.details.delete(old);
    }
    return this.details.get(number);
  }
}

// The overview (docs/view.md) of a run that goes on, as far as its frames are kept here.
export function overviewOf(frames, first_frame, paced) {
  const marks = [], tracks = new Map(), time_ms = [], path = [];
  for (const { frame, status, cause, T, timing, objects } of frames) {
    const last = marks[marks.length - 1];
    if (status !== "good" && last && last.to === frame - 1 && last.status === status && last.cause === cause) last.to = frame;
    else if (status !== "good") marks.push({ from: frame, to: frame, status, cause });
    while (path.length < 3 * (frame - first_frame)) path.push(T[3], T[7], T[11]);
    path.push(T[3], T[7], T[11]);
    time_ms[frame - first_frame] = timing ? (paced ? timing.latency_ms : timing.processing_ms) : null;
    for (const { id, color, cuboid } of objects) addTo(tracks, id, color, cuboid?.kind, frame);
  }
  for (let i = 0; i < time_ms.length; ++i) time_ms[i] ??= null;
  const late = time_ms.map((ms, i) => ({ frame: first_frame + i, ms: ms ?? 0 })).sort((a, b) => b.ms - a.ms).slice(0, 5);
  return { first_frame, frames: time_ms.length, marks, time_ms, path, worst: { camera: [], objects: [], late },
    tracks: [...tracks.values()].sort((a, b) => a.id - b.id) };
}

function addTo(tracks, id, color, kind, frame) {
  if (!tracks.has(id)) tracks.set(id, { id, color, kind: "unknown", spans: [] });
  const track = tracks.get(id), last = track.spans[track.spans.length - 1];
  if (kind) track.kind = kind;
  if (last && last[1] === frame - 1) last[1] = frame;
  else track.spans.push([frame, frame]);
}

// Calls `onReady()` once the run is known, `onFrame({frame, image, other})` with the frame to show, and `onRun(run)` with
// the counts.
export class RunData {
  constructor(onFrame, onRun) {
    this.onFrame = onFrame;
    this.onRun = onRun;
    this.frames = new Map();
    this.details = new Map();
    this.newest = null;
    this.shown = null;
    this.following = true;
    this.state = "connecting";
    this.wanted = null;
    this.loading = false;
    this.token = takeToken();
  }

  // `wanted` is the frame to begin with, or null.
  async start(info, wanted) {
    this.info = info;
    if (info.recorded) this.following = false;
    if (info.recorded) this.overview = await json("/overview.json");
    if (info.against) await (this.other = new OtherRun()).start();
    await this.fetchFrames(info.recorded ? Math.max(info.first_frame, (wanted ?? info.first_frame) - kChunk / 2) : info.first_frame);
    if (!info.recorded && this.frames.has(wanted)) this.following = false;
    this.onReady();
    this.listen();
    if (!this.following) this.show(wanted ?? info.first_frame);
  }

  // The overview of a running run, made from the kept frames.
  currentOverview() {
    if (this.overview) return this.overview;
    const frames = [...this.frames.keys()].sort((a, b) => a - b).slice(-kChunk).map((number) => this.frames.get(number));
    return overviewOf(frames, frames[0]?.frame ?? this.info.first_frame, this.info.paced);
  }

  listen() {
    const events = new EventSource("/events");
    events.onmessage = (event) => {
      this.receive(JSON.parse(event.data));
      if (this.state === "ended") events.close();
    };
    events.onerror = () => {
      if (this.state === "ended") return events.close();
      if (events.readyState === EventSource.CLOSED) return this.tellRefusal();
      if (this.run) this.tell({ ...this.run, state: "unreachable" });
    };
  }

  // If all seats are taken, the browser does not say why.
  async tellRefusal() {
    this.tell({ ...(this.run || {}), state: "refused" });
    setTimeout(() => this.listen(), 5000);
  }

  tell(run) {
    this.state = run.state;
    this.run = run;
    this.onRun(run);
  }

  receive(event) {
    this.tell(event.run);
    if (!event.frame || this.state === "ended") return;  // its image could not be loaded any more
    const number = event.frame.frame;
    const missing = this.newest !== null && number > this.newest + 1;
    if (missing) this.fetchFrames(this.newest + 1).catch(() => {});
    this.keep(event.frame);
    this.details.set(number, event.frame);
    for (const old of this.details.keys()) if (this.details.size > kDetails) this.details.delete(old);
    if (this.following) this.show(this.newest);
  }

  keep(frame) {
    this.frames.set(frame.frame, frame);
    if (this.newest === null || frame.frame > this.newest) this.newest = frame.frame;
    if (this.frames.size > kKept) this.frames.delete(this.frames.keys().next().value);
  }

  async fetchFrames(from) {
    const { frames } = await json(`/frames.json?from=${from}&count=${kChunk}`);
    for (const frame of frames) if (!this.frames.has(frame.frame)) this.keep(frame);
  }

  get first() {
    if (this.info.recorded || this.frames.size === 0) return this.info.first_frame;
    let first = Infinity;
    for (const number of this.frames.keys()) first = Math.min(first, number);
    return first;
  }
  get last() { return this.info.recorded ? this.info.end_frame - 1 : this.newest ?? this.info.first_frame; }

  // Frames up to the one shown, oldest first.
  past(count) {
    const frames = [];
    for (let number = this.shown; number > this.shown - count; --number) {
      const frame = this.frames.get(number);
      if (frame) frames.push(frame);
    }
    return frames.reverse();
  }

  // Frames near the shown one, oldest first, with later ones if the run is over.
  around(count) {
    if (!this.info.recorded) return this.past(count);
    const from = Math.max(this.first, Math.min(this.shown - Math.floor(count / 2), this.last + 1 - count)), frames = [];
    for (let number = from; number < from + count; ++number) {
      const frame = this.frames.get(number);
      if (frame) frames.push(frame);
    }
    return frames;
  }

  // The newest request wins; one is fetched at a time.
  show(number) {
    this.wanted = Math.max(this.first, Math.min(this.last, number));
    if (!this.loading) this.load();
  }

  async load() {
    this.loading = true;
    while (this.wanted !== null) {
      const number = this.wanted;
      this.wanted = null;
      const [detail, image, other] = await Promise.all(
        [this.detailOf(number), this.imageOf(number), this.other?.frame(number) ?? null]);
      if (!detail) continue;
      this.shown = number;
      this.onFrame({ frame: detail, image, other });
    }
    this.loading = false;
  }

  async detailOf(number) {
    if (this.details.has(number)) return this.details.get(number);
    try {
      if (this.info.recorded && !this.frames.has(number)) await this.fetchFrames(Math.max(this.info.first_frame, number - 200));
      return await json(`/frame/${number}.json`);
    } catch { return this.frames.get(number) ?? null; }
  }

  async imageOf(number) {
    try {
      const answer = await fetch(`/image/${number}.jpg`);
      return answer.ok ? await createImageBitmap(await answer.blob()) : null;
    } catch { return null; }
  }

  // A token of an earlier run at the same address is refused.
  async control(action) {
    const answer = await fetch(`/control/${action}?token=${this.token}`).catch(() => null);
    if (answer?.status !== 403) return;
    this.token = "";
    this.tell(this.run);
  }
}
