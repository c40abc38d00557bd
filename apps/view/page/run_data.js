// What the server tells (docs/view.md): the run, its frames as far as they are kept here, and which of them is shown.

const kKept = 4000;
const kChunk = 600;

async function json(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error((await answer.text()).trim() || answer.statusText);
  return answer.json();
}

// Calls `onFrame({frame, detail, image})` with the frame that is to be shown, and `onRun(run)` with the counts.
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
  }

  async start() {
    this.info = await json("/run.json");
    await this.fetchFrames(this.info.first_frame);
    if (this.info.recorded) this.following = false;
    this.listen();
    if (this.info.recorded) this.show(this.info.first_frame);
    return this.info;
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

  // Where all places are taken, the browser does not say why.
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
    for (const old of this.details.keys()) if (this.details.size > 60) this.details.delete(old);
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

  // The newest wish wins; one is fetched at a time.
  show(number) {
    this.wanted = Math.max(this.first, Math.min(this.last, number));
    if (!this.loading) this.load();
  }

  async load() {
    this.loading = true;
    while (this.wanted !== null) {
      const number = this.wanted;
      this.wanted = null;
      const [detail, image] = await Promise.all([this.detailOf(number), this.imageOf(number)]);
      if (!detail) continue;
      this.shown = number;
      this.onFrame({ frame: detail, image });
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

  control(action) { return fetch(`/control/${action}?token=${this.info.token}`).catch(() => {}); }
}
