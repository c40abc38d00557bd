// The frames to look at first: those with the largest errors, the slowest ones, and those that were not tracked.

const element = (id) => document.getElementById(id);
const kMost = 8;

export class WorstPanel {
  constructor(onGo) {
    this.onGo = onGo;
    this.key = "";
  }

  set(worst, marks, paced) {
    const key = JSON.stringify([worst, marks]);
    if (key === this.key) return;
    this.key = key;
    const entry = (text) => ({ frame, track, ...rest }) => ({ frame, track, text: text({ frame, track, ...rest }) });
    const groups = [
      ["Camera motion error", worst.camera.map(entry(({ step_m }) => `${(100 * step_m).toFixed(1)} cm`))],
      ["Object motion error", worst.objects.map(entry(({ track, motion_m }) => `#${track} ${motion_m.toFixed(2)} m`))],
      ["Not simply tracked", marks.map(({ from, status }) => ({ frame: from, text: status }))],
      [paced ? "Latest" : "Slowest", worst.late.map(entry(({ ms }) => `${ms.toFixed(1)} ms`))],
    ];
    element("worst").replaceChildren(...groups.filter(([, entries]) => entries.length > 0).flatMap((group) => this.group(...group)));
  }

  group(title, entries) {
    const heading = document.createElement("h3"), list = document.createElement("ul");
    heading.textContent = title;
    list.append(...entries.slice(0, kMost).map(({ frame, track, text }) => {
      const item = document.createElement("li"), button = document.createElement("button");
      button.type = "button";
      button.dataset.frame = frame;
      button.append(String(frame), Object.assign(document.createElement("small"), { textContent: text }));
      button.setAttribute("aria-label", `frame ${frame}, ${title}: ${text}`);
      button.addEventListener("click", () => this.onGo(frame, track ?? null));
      item.append(button);
      return item;
    }));
    return [heading, list];
  }

  show(frame) {
    for (const button of element("worst").querySelectorAll("button")) {
      if (Number(button.dataset.frame) === frame) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
  }
}
