// A row for each object with the frames in which it was followed, and for each label with those in which it moved. A
// click goes there.

const element = (id) => document.getElementById(id);
const kRest_ms = 400;

const frames = (spans) => spans.reduce((sum, [from, to]) => sum + to - from + 1, 0);

export class TracksPanel {
  constructor(onGo) {
    this.onGo = onGo;
    this.key = "";
    this.scroll_due = 0;
  }

  // `labels` stand below the first track that followed them; labels that nothing followed stand where they began.
  set({ tracks, labels = [] }, [first, last]) {
    const key = JSON.stringify([first, last, tracks.map(({ id, spans }) => [id, spans]), labels.length]);
    if (key === this.key) return;
    this.key = key;
    this.range = [first, last];
    const rows = tracks.map((track) => ({ ...track, name: `#${track.id}`, more: track.kind.replaceAll("_", " ").replace("unknown", "") }));
    for (const label of labels) {
      const at = rows.findIndex(({ id, label: of }) => of === undefined && id === label.tracks[0]);
      const row = { ...label, label: label.id, name: `label ${label.id}`, more: label.tracks.length > 0 ? label.type : `${label.type}, not followed` };
      if (at >= 0) rows.splice(at + 1, 0, row);
      else rows.push(row);
    }
    element("track-count").textContent = tracks.length > 0 ? tracks.length : "";
    element("no-tracks").hidden = rows.length > 0;
    element("tracks").replaceChildren(...rows.map((row) => this.row(row)));
    this.bars = [...element("tracks").children].map((item, i) => ({ item, row: rows[i] }));
  }

  row(row) {
    const item = document.createElement("li"), button = document.createElement("button"), name = document.createElement("span"),
      bar = document.createElement("span"), cursor = document.createElement("b");
    const [first, last] = this.range, of = Math.max(1, last - first);
    button.type = "button";
    name.className = "name";
    name.append(row.name, Object.assign(document.createElement("small"), { textContent: row.more }));
    bar.className = "bar";
    for (const [from, to] of row.spans) {
      const part = document.createElement("i");
      part.style.left = `${100 * (from - first) / of}%`;
      part.style.width = `${100 * (to - from) / of}%`;
      if (row.color) part.style.background = row.color;
      bar.append(part);
    }
    bar.append(cursor);
    item.classList.toggle("label-row", row.label !== undefined);
    item.classList.toggle("alone", row.label !== undefined && row.tracks.length === 0);
    button.setAttribute("aria-label", `${row.name} ${row.more}: ${frames(row.spans)} frames from ${row.spans[0][0]} to ${row.spans.at(-1)[1]}`);
    button.addEventListener("click", (event) => this.go(event, row, bar));
    button.append(name, bar);
    item.append(button);
    return item;
  }

  // Goes to the frame under the pointer, or the nearest one with the object; by keys to its first frame.
  go(event, row, bar) {
    const box = bar.getBoundingClientRect(), [first, last] = this.range;
    const wanted = event.detail === 0 || event.clientX < box.left ? row.spans[0][0] :
      first + Math.round((event.clientX - box.left) / Math.max(1, box.width) * (last - first));
    const near = row.spans.map(([from, to]) => Math.min(Math.max(wanted, from), to));
    const frame = near.reduce((a, b) => (Math.abs(b - wanted) < Math.abs(a - wanted) ? b : a));
    this.onGo(frame, row.label === undefined ? row.id : row.tracks[0] ?? null);
  }

  show(frame, chosen) {
    if (!this.bars) return;
    const [first, last] = this.range;
    element("tracks").style.setProperty("--at", `${100 * (frame - first) / Math.max(1, last - first)}%`);
    for (const { item, row } of this.bars) {
      item.classList.toggle("here", row.spans.some(([from, to]) => frame >= from && frame <= to));
      item.classList.toggle("chosen", row.label === undefined && row.id === chosen);
    }
    this.scrollToHere();
  }

  // Scrolls the rows of present objects into view, unless the user is in the list.
  scrollToHere() {
    const list = element("tracks"), box = list.parentElement, first = list.querySelector(".here");
    if (performance.now() < this.scroll_due || !first || box.scrollHeight <= box.clientHeight || box.matches(":hover, :focus-within")) return;
    this.scroll_due = performance.now() + kRest_ms;
    const top = first.offsetTop - list.offsetTop;
    if (top < box.scrollTop || top + first.offsetHeight > box.scrollTop + box.clientHeight) box.scrollTop = Math.max(0, top - 30);
  }
}
