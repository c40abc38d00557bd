// Connects the panels: the shown frame, the chosen object, the buttons and keys.
import { DifferencePanel } from "/difference_panel.js";
import { FrameLink, readLink } from "/frame_link.js";
import { HistoryPanel } from "/history_panel.js";
import { ImagePanel } from "/image_panel.js";
import { MapPanel } from "/map_panel.js";
import { ObjectsPanel } from "/objects_panel.js";
import { RunData } from "/run_data.js";
import { ScenePanel } from "/scene_panel.js";
import { TimelinePanel } from "/timeline_panel.js";
import { TimingPanel } from "/timing_panel.js";
import { TracksPanel } from "/tracks_panel.js";
import { WorstPanel } from "/worst_panel.js";

const element = (id) => document.getElementById(id);
const kPast = 600, kPathBehind = 150, kPathAhead = 30, kTimes = 200, kOverview_ms = 1000, kMostMapMarks = 5;
const kStates = {
  running: ["live", "good"], paused: ["paused", "warn"], recorded: ["finished run", ""], connecting: ["connecting", ""],
  ended: ["ended; open it with motorcade view RUN", ""], unreachable: ["ended, or not reachable", "warn"],
  refused: ["all places are taken; trying again", "bad"],
};
const kTracking = { good: ["tracking", "good"], degraded: ["tracking, degraded", "warn"], lost: ["lost", "bad"], rejected: ["image rejected", "bad"], dropped: ["dropped", "warn"] };
const kMayNotHold = "Only the page at the address that motorcade printed can hold the run";

let chosen = null, shown = null, playing = false, truthOn = true, info = null, timing = null, scene = null, overviewDue = 0;
const image = new ImagePanel(element("image"), choose), otherImage = new ImagePanel(element("image-other"), () => {});
const history = new HistoryPanel(), difference = new DifferencePanel();
const data = new RunData(showFrame, showRun);
const link = new FrameLink(({ frame, object }) => { chosen = object; goTo(frame, { linked: true }); });
const objects = new ObjectsPanel((id) => choose(id === chosen ? null : id), jumpTo);
const timeline = new TimelinePanel((frame, jump) => (jump ? jumpTo(frame) : goTo(frame)));
const tracks = new TracksPanel(jumpTo), worst = new WorstPanel(jumpTo), map = new MapPanel(element("map"), jumpTo);

function showFrame(now) {
  shown = now;
  const { frame, image: picture } = now, past = data.past(kPast);
  element("no-image").hidden = picture !== null;
  if (!info.recorded && performance.now() > overviewDue) showOverview();
  timing.showFrame(frame, past, data.around(kTimes));
  const [tracking, kind] = kTracking[frame.status];
  element("tracking").textContent = frame.cause === "none" ? tracking : `${tracking}: ${frame.cause.replaceAll("_", " ")}`;
  element("tracking").className = `pill ${kind}`;
  const scrub = element("scrub");
  scrub.min = data.first;
  scrub.max = data.last;
  scrub.value = frame.frame;
  element("clock").textContent = `frame ${frame.frame}, ${frame.time.toFixed(1)} s`;
  showObjects(past);
  timeline.show(frame.frame);
  worst.show(frame.frame);
  if (info.against) difference.show(frame, now.other);
  document.body.dataset.frame = frame.frame;
}

function showObjects(past) {
  const { frame, image: picture, other } = shown;
  image.show(frame, picture, chosen, truthOn);
  if (info.against) otherImage.show(other ?? { ...frame, objects: [], outlines: [], points: [] }, picture, null, truthOn);
  scene?.show(frame, past, chosen, extraOf(frame.frame, other));
  const around = data.around(kPast);
  history.show(chosen, frame, around, drivenTo(around[0]?.frame));
  objects.show(frame, chosen, data.overview?.tracks);
  tracks.show(frame.frame, chosen);
  map.show(frame, truthOn);
}

// Further paths of the scene: the true one around this frame, and the other run's up to it.
function extraOf(frame, other) {
  const part = ({ path }, first, behind, ahead) => path.slice(3 * Math.max(0, frame - first - behind), 3 * Math.max(0, frame - first + ahead + 1));
  const truth = data.overview?.truth;
  return { true_path: truth && truthOn ? part(truth, data.overview.first_frame, kPathBehind, kPathAhead) : null, other,
    other_path: data.other ? part(data.other.overview, data.other.info.first_frame, kPast, 0) : null };
}

function drivenTo(frame) {
  if (!data.overview) return 0;
  const { path, first_frame } = data.overview, end = 3 * Math.max(0, (frame ?? first_frame) - first_frame);
  let driven = 0;
  for (let i = 3; i <= end && i + 2 < path.length; i += 3) driven += Math.hypot(path[i] - path[i - 3], path[i + 1] - path[i - 2], path[i + 2] - path[i - 1]);
  return driven;
}

function showOverview() {
  overviewDue = performance.now() + kOverview_ms;
  const overview = data.currentOverview(), range = [data.first, data.last], { truth } = overview;
  timeline.setOverview(overview.marks, curvesOf(overview), range);
  tracks.set({ tracks: overview.tracks, labels: truth?.labels }, range);
  worst.set(overview.worst, overview.marks, info.paced);
  const paths = [{ name: "camera", color: "--accent", path: overview.path, first_frame: overview.first_frame, wide: 2.5 }];
  if (data.other) paths.push({ name: "other run", color: "--second", path: data.other.overview.path, dash: [8, 3] });
  if (truth) paths.push({ name: "truth", color: "--ink", path: truth.path, dash: [4, 4], wide: 1.5, of_truth: true });
  const marks = truth ? overview.worst.camera.slice(0, kMostMapMarks).map(({ frame }) => frame) : [];
  map.set(paths, marks);
  element("map-legend").replaceChildren(...paths.map(({ name, color, dash }) => key(name, color, "line", Boolean(dash))), ...(marks.length > 0 ? [key("largest errors of motion", "--bad", "mark")] : []));
}

function key(name, color, kind = "line", dash = false) {
  const entry = document.createElement("span");
  entry.className = `legend-${kind}`;
  entry.style.setProperty("--color", `var(${color})`);
  entry.style.setProperty("--line-style", dash ? "dashed" : "solid");
  entry.textContent = name;
  return entry;
}

function curvesOf(overview) {
  const { truth, first_frame } = overview, other = data.other?.overview, curves = [];
  const lines = (of) => [{ values: of(overview), first_frame, color: "--accent" },
    ...(other && of(other) ? [{ values: of(other), first_frame: other.first_frame, color: "--second", dash: [5, 3] }] : [])];
  if (other) curves.push({ name: "cameras apart", unit: "m", digits: 3, lines: [{ values: apartOf(overview, other), first_frame, color: "--ink" }] });
  if (truth) curves.push({ name: "camera position error", unit: "m", digits: 3, lines: lines(({ truth: t }) => t?.position_m) },
    { name: "camera motion error", unit: "m", digits: 4, lines: lines(({ truth: t }) => t?.step_m) });
  if (truth?.object_source) curves.push({ name: "largest motion error of an object", unit: "m", digits: 3, lines: lines(({ truth: t }) => t?.motion_m) });
  curves.push({ name: info.paced ? "latency" : "processing", unit: "ms", digits: 1, lines: lines((of) => (of === overview || data.other.info.paced === info.paced ? of.time_ms : null)) });
  return curves;
}

function apartOf(a, b) {
  return Array.from({ length: a.frames }, (_, i) => {
    const j = i + a.first_frame - b.first_frame;
    if (j < 0 || j >= b.frames) return null;
    return Math.hypot(...[0, 1, 2].map((k) => a.path[3 * i + k] - b.path[3 * j + k]));
  });
}

function choose(id) {
  chosen = id;
  if (!shown) return;
  showObjects(data.past(kPast));
  if (!data.following && !playing) link.write(shown.frame.frame, chosen);
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
  const over = data.state === "ended" || data.state === "unreachable", mayHold = info.recorded || (info.can_pause && data.token !== "");
  element("play").textContent = held ? "Play" : "Pause";
  element("play").disabled = !mayHold || (!info.recorded && over);
  element("play").title = mayHold || !info.can_pause ? "Pause or go on (Space)" : kMayNotHold;
  element("newest").hidden = info.recorded;
  element("newest").disabled = data.following;
}

// The page itself plays a run that is over.
function play(on) {
  if (playing && !on) link.write(data.shown, chosen);
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
  if (element("play").disabled) return;
  if (data.state === "paused") follow();
  data.control(data.state === "paused" ? "resume" : "pause");
}

function follow() {
  data.following = !info.recorded;
  data.show(data.last);
  showButtons();
}

function goTo(number, { linked = false, jump = false } = {}) {
  const wanted = Math.max(data.first, Math.min(data.last, number));
  if (info.recorded) play(false);
  data.following = !info.recorded && wanted >= data.last;
  data.show(wanted);
  if (!linked && !data.following) link.write(wanted, chosen, jump);
  showButtons();
}

// Makes the browser's back button return to the previous position.
function jumpTo(number, object = chosen) {
  chosen = object ?? chosen;
  goTo(number, { jump: true });
}

function step(by) {
  if (shown === null) return;
  if (by > 0 && !info.recorded && data.shown >= data.last) {
    if (info.can_pause && data.token) data.control("step");
    return;
  }
  goTo(data.shown + by);
}

// Keys that a focused slider or button handles itself.
const kOwnKeys = { button: [" ", "Enter"], input: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"] };

function keyPressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (kOwnKeys[event.target.localName]?.includes(event.key)) return;
  const act = { " ": toggle, ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => goTo(data.first), End: follow,
    Escape: () => choose(null), a: () => scene?.look("above"), b: () => scene?.look("behind"), f: toggleFollow, t: toggleTruth, l: copyLink }[event.key];
  if (!act) return;
  event.preventDefault();
  act();
}

function toggleFollow() {
  if (!scene) return;
  scene.follow = !scene.follow;
  element("view-follow").setAttribute("aria-pressed", scene.follow);
}

function toggleTruth() {
  if (!data.overview?.truth) return;
  truthOn = !truthOn;
  element("truth").setAttribute("aria-pressed", truthOn);
  element("truth-key").hidden = !truthOn;
  if (shown) showObjects(data.past(kPast));
}

async function copyLink() {
  if (!shown) return;
  await link.copy(shown.frame.frame, chosen);
  element("copy-link").textContent = "Copied";
  setTimeout(() => { element("copy-link").textContent = "Link"; }, 1500);
}

function listen() {
  const on = (id, act, type = "click") => element(id).addEventListener(type, act);
  on("play", toggle);
  on("back", () => step(-1));
  on("forth", () => step(1));
  on("newest", follow);
  on("truth", toggleTruth);
  on("copy-link", copyLink);
  on("history-close", () => choose(null));
  on("scrub", (event) => goTo(Number(event.target.value)), "input");
  on("view-above", () => scene?.look("above"));
  on("view-behind", () => scene?.look("behind"));
  on("view-follow", toggleFollow);
  document.addEventListener("keydown", keyPressed);
}

// Panels that only some runs have.
function showParts() {
  const hasTruth = Boolean(data.overview?.truth);
  element("truth").hidden = element("truth-key").hidden = !hasTruth;
  if (!info.against) return;
  document.body.classList.add("two");
  for (const id of ["other-image", "image-name", "difference-card", "other-key"]) element(id).hidden = false;
  element("image-name").textContent = info.folder;
  element("other-name").textContent = info.against;
}

async function start() {
  try {
    scene = new ScenePanel(element("scene"), choose);
  } catch {
    element("scene").textContent = "The scene needs WebGL, which this browser does not have.";
  }
  const answer = await fetch("/run.json"), wanted = readLink();
  if (!answer.ok) throw new Error(await answer.text());
  info = data.info = await answer.json();
  document.title = `${info.name} \u2013 Motorcade`;
  element("run-name").textContent = info.name;
  element("run-name").title = info.folder;
  for (const panel of [image, otherImage, scene]) panel?.setCamera(info.camera);
  Object.assign(Chart.defaults.font, { family: "system-ui, sans-serif", size: 11 });
  chosen = wanted.object;
  data.onReady = () => {
    timing = new TimingPanel(info, data.overview?.timing);
    showParts();
    showOverview();
  };
  listen();
  await data.start(info, wanted.frame);
}

start().catch((error) => {
  element("run-state").textContent = error.message;
  element("run-state").className = "pill bad";
});
