// The objects of the shown frame; where there is truth, each with its distance from it.

const element = (id) => document.getElementById(id);
const text = (value, digits) => (value === undefined || value === null ? "" : value.toFixed(digits));

export class ObjectsPanel {
  constructor(onChoose, onGo) {
    this.onChoose = onChoose;
    this.onGo = onGo;
    this.body = element("objects").tBodies[0];
  }

  show(frame, chosen, tracks) {
    const objects = [...frame.objects].sort((a, b) => a.id - b.id);
    element("object-count").textContent = objects.length > 0 ? objects.length : "";
    element("objects").classList.toggle("true", Boolean(frame.truth));
    this.showNone(frame, objects, tracks);
    const rows = this.body.rows;
    if (rows.length !== objects.length || objects.some((o, i) => Number(rows[i].dataset.id) !== o.id))
      this.body.replaceChildren(...objects.map((object) => this.row(object)));
    objects.forEach((object, i) => this.fill(rows[i], object, chosen, frame.truth));
    this.showMissed(frame);
  }

  // A link to the next object, where nothing moves.
  showNone(frame, objects, tracks) {
    element("no-objects").hidden = objects.length > 0;
    element("objects").hidden = objects.length === 0;
    const starts = (tracks ?? []).flatMap(({ spans }) => spans.map(([from]) => from));
    const later = starts.filter((from) => from > frame.frame), next = later.length > 0 ? Math.min(...later) : null;
    const button = element("next-object");
    button.hidden = objects.length > 0 || next === null;
    button.textContent = `Next object in frame ${next}`;
    button.onclick = () => this.onGo(next);
  }

  fill(row, object, chosen, truth) {
    row.classList.toggle("chosen", object.id === chosen);
    row.querySelector("button").setAttribute("aria-pressed", object.id === chosen);
    row.querySelector(".kind").textContent = object.state === "moving" ?
      (object.cuboid?.kind ?? "").replaceAll("_", " ").replace("unknown", "") : object.state;
    const cell = (k, value, digits, sigma) => {
      row.cells[k].firstChild.textContent = text(value, digits);
      row.cells[k].lastChild.textContent = sigma === undefined ? "" : ` \u00b1 ${sigma.toFixed(1)}`;
    };
    cell(1, object.speed, 1, object.speed_sigma);
    cell(2, object.distance, 1, object.distance_sigma);
    const label = truth?.objects.find(({ track }) => track === object.id);
    cell(3, 100 * object.existence, 0);
    cell(4, label?.off_m, 2);
    cell(5, label?.motion_m, 3);
  }

  row(object) {
    const row = document.createElement("tr");
    row.dataset.id = object.id;
    const button = document.createElement("button"), swatch = document.createElement("span"), kind = document.createElement("small");
    button.type = "button";
    swatch.className = "swatch";
    swatch.style.background = object.color;
    kind.className = "kind";
    button.append(swatch, `#${object.id}`, kind);
    button.addEventListener("click", () => this.onChoose(object.id));
    row.insertCell().append(button);
    for (let i = 0; i < 5; ++i) row.insertCell().append(document.createElement("span"), document.createElement("small"));
    row.cells[4].className = row.cells[5].className = "of-truth";
    return row;
  }

  showMissed(frame) {
    const missed = (frame.truth?.objects ?? []).filter(({ moving, track }) => moving && track === undefined);
    element("missed").hidden = missed.length === 0;
    element("missed").textContent = `Moves, but is not followed: ${missed.map(({ id, type }) => `label ${id} (${type})`).join(", ")}`;
  }
}
