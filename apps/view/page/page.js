// Joins the panels: which frame is shown, which object is chosen, what the buttons and keys do.
import { HistoryPanel } from "/history_panel.js";
import { ImagePanel } from "/image_panel.js";
import { RunData } from "/run_data.js";
import { ScenePanel } from "/scene_panel.js";
import { TimingPanel } from "/timing_panel.js";

const element = (id) => document.getElementById(id);
const kPast = 600;
const kStates = {
  running: ["live", "good"], paused: ["paused", "warn"], recorded: ["finished run", ""], connecting: ["connecting", ""],
  ended: ["ended; open it with motorcade view RUN", ""], unreachable: ["ended, or not reachable", "warn"],
  refused: ["all places are taken; trying again", "bad"],
};
const kTracking = { good: ["tracking", "good"], degraded: ["tracking, degraded", "warn"], lost: ["lost", "bad"], rejected: ["image rejected", "bad"], dropped: ["dropped", "warn"] };

let chosen = null, shownFrame = null, shownImage = null, playing = false, info = null, timing = null, scene = null;
const image = new ImagePanel(element("image"), choose);
const history = new HistoryPanel();
const data = new RunData(showFrame, showRun);

function showFrame({ frame, image: picture }) {
  shownFrame = frame;
  shownImage = picture;
  element("no-image").hidden = picture !== null;
  const past = data.past(kPast);
  timing.showFrame(frame, past);
  element("tracking").textContent = frame.cause === "none" ? kTracking[frame.status][0] : `${kTracking[frame.status][0]}: ${frame.cause.replaceAll("_", " ")}`;
  element("tracking").className = `pill ${kTracking[frame.status][1]}`;
  const scrub = element("scrub");
  scrub.min = data.first;
  scrub.max = data.last;
  scrub.value = frame.frame;
  element("clock").textContent = `frame ${frame.frame}, ${frame.time.toFixed(1)} s`;
  showObjects(past);
  document.body.dataset.frame = frame.frame;
}

function showObjects(past) {
  image.show(shownFrame, shownImage, chosen);
  scene?.show(shownFrame, past, chosen);
  history.show(chosen, past);
  listObjects();
}

function listObjects() {
  const objects = [...shownFrame.objects].sort((a, b) => a.id - b.id), body = element("objects").tBodies[0];
  element("object-count").textContent = objects.length > 0 ? objects.length : "";
  element("no-objects").hidden = objects.length > 0;
  const same = body.rows.length === objects.length && objects.every((o, i) => Number(body.rows[i].dataset.id) === o.id);
  if (!same) body.replaceChildren(...objects.map(objectRow));
  objects.forEach((object, i) => {
    const row = body.rows[i];
    row.classList.toggle("chosen", object.id === chosen);
    row.querySelector("button").setAttribute("aria-pressed", object.id === chosen);
    row.querySelector(".kind").textContent = object.state === "moving" ? (object.cuboid?.kind ?? "").replaceAll("_", " ").replace("unknown", "") : object.state;
    const cell = (k, value, sigma) => {
      row.cells[k].firstChild.textContent = value === undefined ? "" : value.toFixed(1);
      row.cells[k].lastChild.textContent = sigma === undefined ? "" : ` \u00b1 ${sigma.toFixed(1)}`;
    };
    cell(1, object.speed, object.speed_sigma);
    cell(2, object.distance, object.distance_sigma);
  });
}

function objectRow(object) {
  const row = document.createElement("tr");
  row.dataset.id = object.id;
  const button = document.createElement("button"), swatch = document.createElement("span"), kind = document.createElement("small");
  button.type = "button";
  swatch.className = "swatch";
  swatch.style.background = object.color;
  kind.className = "kind";
  button.append(swatch, `#${object.id}`, kind);
  button.addEventListener("click", () => choose(object.id === chosen ? null : object.id));
  row.insertCell().append(button);
  for (let i = 0; i < 2; ++i) row.insertCell().append(document.createElement("span"), document.createElement("small"));
  return row;
}

function choose(id) {
  chosen = id;
  if (shownFrame) showObjects(data.past(kPast));
}

function showRun(run) {
  const [text, kind] = kStates[run.state] ?? [run.state, ""];
  element("run-state").textContent = text;
  element("run-state").className = `pill ${kind}`;
  timing?.showRun(run);
  showButtons();
}

function showButtons() {
  const held = info.recorded ? !playing : data.state === "paused";
  const over = data.state === "ended" || data.state === "unreachable";
  element("play").textContent = held ? "Play" : "Pause";
  element("play").disabled = !info.recorded && (!info.can_pause || over);
  element("newest").hidden = info.recorded;
  element("newest").disabled = data.following;
}

// Of a run that is over, the page itself is the player.
function play(on) {
  playing = on;
  showButtons();
  const step = () => {
    if (!playing) return;
    if (data.shown >= data.last) return play(false);
    data.show(data.shown + 1);
    setTimeout(step, 1000 / info.rate_hz);
  };
  if (on && data.shown >= data.last) data.show(data.first);
  if (on) setTimeout(step, 1000 / info.rate_hz);
}

function toggle() {
  if (info.recorded) return play(!playing);
  if (!info.can_pause) return;
  if (data.state === "paused") follow();
  data.control(data.state === "paused" ? "resume" : "pause");
}

function follow() {
  data.following = !info.recorded;
  data.show(data.last);
  showButtons();
}

function goTo(number) {
  if (info.recorded) play(false);
  data.following = !info.recorded && number >= data.last;
  data.show(number);
  showButtons();
}

function step(by) {
  if (shownFrame === null) return;
  if (by > 0 && !info.recorded && data.shown >= data.last) {
    if (info.can_pause) data.control("step");
    return;
  }
  goTo(data.shown + by);
}

function key(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.matches("input, button") && [" ", "ArrowLeft", "ArrowRight", "End", "Home"].includes(event.key)) return;
  const act = { " ": toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => goTo(data.first), End: follow,
    Escape: () => choose(null), a: () => scene?.look("above"), b: () => scene?.look("behind"), f: toggleFollow }[event.key];
  if (!act) return;
  event.preventDefault();
  act();
}

function toggleFollow() {
  if (!scene) return;
  scene.follow = !scene.follow;
  element("view-follow").setAttribute("aria-pressed", scene.follow);
}

function listen() {
  element("play").addEventListener("click", toggle);
  element("back").addEventListener("click", () => step(-1));
  element("forth").addEventListener("click", () => step(1));
  element("newest").addEventListener("click", follow);
  element("scrub").addEventListener("input", (event) => goTo(Number(event.target.value)));
  element("view-above").addEventListener("click", () => scene?.look("above"));
  element("view-behind").addEventListener("click", () => scene?.look("behind"));
  element("view-follow").addEventListener("click", toggleFollow);
  document.addEventListener("keydown", key);
}

async function start() {
  try {
    scene = new ScenePanel(element("scene"), choose);
  } catch {
    element("scene").textContent = "The scene needs WebGL, which this browser does not have.";
  }
  info = data.info = await (await fetch("/run.json")).json();
  document.title = `${info.name} \u2013 Motorcade`;
  element("run-name").textContent = info.name;
  element("run-name").title = info.folder;
  image.setCamera(info.camera);
  scene?.setCamera(info.camera);
  timing = new TimingPanel(info);
  Object.assign(Chart.defaults.font, { family: "system-ui, sans-serif", size: 11 });
  listen();
  await data.start();
}

start().catch((error) => {
  element("run-state").textContent = error.message;
  element("run-state").className = "pill bad";
});
