// Two runs of one drive in the same frame: their distance from each other, and each run's from the truth.

const element = (id) => document.getElementById(id);
const kNear_m = 3;  // two estimates of one object are closer

// Angle between two poses by its sine, which is exact for small angles, unlike the cosine.
function angle_deg(A, B) {
  const turn = (i, j) => [0, 4, 8].reduce((sum, row) => sum + A[row + i] * B[row + j], 0);  // of A's inverse times B
  const sine = Math.hypot(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)) / 2;
  return Math.atan2(sine, (turn(0, 0) + turn(1, 1) + turn(2, 2) - 1) / 2) * 180 / Math.PI;
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const origin = (T) => [T[3], T[7], T[11]];
const seen = (T, p) => {
  const d = p.map((value, i) => value - origin(T)[i]);
  return [0, 1, 2].map((i) => T[i] * d[0] + T[4 + i] * d[1] + T[8 + i] * d[2]);
};

// Objects of both runs that are at the same position as seen from their cameras, the closest first.
export function sameObjects(a, b) {
  const pairs = a.objects.flatMap((mine) => b.objects.map((theirs) =>
    ({ mine, theirs, apart: distance(seen(a.T, mine.center), seen(b.T, theirs.center)) })));
  const taken = new Set(), same = [];
  for (const pair of pairs.filter(({ apart }) => apart < kNear_m).sort((p, q) => p.apart - q.apart)) {
    const keys = [`a${pair.mine.id}`, `b${pair.theirs.id}`];
    if (keys.some((key) => taken.has(key))) continue;
    keys.forEach((key) => taken.add(key));
    same.push(pair);
  }
  return same;
}

export class DifferencePanel {
  show(frame, other) {
    element("no-difference").hidden = other !== null;
    element("difference").hidden = other === null;
    if (other === null) return;
    const text = (value, digits, unit) => (value === undefined ? "\u2013" : `${value.toFixed(digits)} ${unit}`);
    const rows = [["", "this run", "the other"]];
    const truth = frame.truth && other.truth;
    if (truth) {
      rows.push(["camera position error", text(frame.truth.position_m, 3, "m"), text(other.truth.position_m, 3, "m")]);
      rows.push(["camera motion error", text(100 * frame.truth.step_m, 2, "cm"), text(100 * other.truth.step_m, 2, "cm")]);
      rows.push(["camera rotation error", text(frame.truth.step_deg, 3, "deg"), text(other.truth.step_deg, 3, "deg")]);
    }
    rows.push(["objects in view", String(frame.objects.length), String(other.objects.length)]);
    this.fill(element("difference-values"), rows);
    element("apart").textContent = `Cameras ${distance(origin(frame.T), origin(other.T)).toFixed(3)} m and ${angle_deg(frame.T, other.T).toFixed(3)} deg apart`;
    const same = sameObjects(frame, other);
    this.fill(element("difference-objects"), [["object", "the other\u2019s", "apart m", "speed m/s"], ...same.map(({ mine, theirs, apart }) =>
      [`#${mine.id}`, `#${theirs.id}`, apart.toFixed(2), `${(mine.speed - theirs.speed >= 0 ? "+" : "\u2212")}${Math.abs(mine.speed - theirs.speed).toFixed(2)}`])]);
    element("difference-objects").hidden = same.length === 0;
  }

  fill(table, [head, ...rows]) {
    const row = (cells, tag) => {
      const line = document.createElement("tr");
      line.append(...cells.map((cell, i) => Object.assign(document.createElement(i === 0 && tag === "td" ? "th" : tag), { textContent: cell, scope: tag === "th" ? "col" : "row" })));
      return line;
    };
    table.tHead.replaceChildren(row(head, "th"));
    table.tBodies[0].replaceChildren(...rows.map((cells) => row(cells, "td")));
  }
}
