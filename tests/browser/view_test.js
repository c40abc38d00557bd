// The page of `motorcade run --view` and `motorcade view`.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, checkWidth, goTo, kUrl, reaches, run, screenshot, shown, shows, start, test, withBrowser, withPage } from "./harness.js";

const folder = mkdtempSync(join(tmpdir(), "motorcade_browser_"));
const drive = join(folder, "drive"), long = join(folder, "long"), results = join(folder, "run");
const kShown = Number(process.env.MOTORCADE_SHOWN_FRAME || 20);

// Tracks with a row in a frame of objects_final.csv.
function tracksIn(frame) {
  const rows = readFileSync(join(results, "objects_final.csv"), "utf8").split("\n").map((line) => line.split(","));
  return rows.filter((row) => row[0] === String(frame)).map((row) => `#${row[1]}`);
}

// Whether anything but one color is to be seen.
const painted = (page, selector) => page.locator(selector).evaluate((canvas) => {
  const copy = document.createElement("canvas");
  Object.assign(copy, { width: 64, height: 32 });
  copy.getContext("2d").drawImage(canvas, 0, 0, 64, 32);
  return new Set(new Uint32Array(copy.getContext("2d").getImageData(0, 0, 64, 32).data.buffer)).size > 20;
});

async function recorded(browser) {
  const server = await start(["view", results, "--view", "127.0.0.1:0"], kUrl), url = server.found;
  await test("a finished run shows the objects of its files", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kShown);
    const tracks = tracksIn(kShown), listed = await page.locator("#objects tbody button").allTextContents();
    check(tracks.length > 0, "the drive has no object to look for");
    check(JSON.stringify(listed.map((text) => text.match(/#\d+/)[0]).sort()) === JSON.stringify(tracks.sort()),
      `the list says ${listed}, the file ${tracks}`);
    check(await painted(page, "#image"), "the image is empty");
    check(await page.locator(".label:visible").count() > 0, "no object has its name in the scene");
  }));
  await test("a click on an object in the image shows its history", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kShown);
    check(await page.locator("#history-title").textContent() === "History of the camera", "not the camera's history before any object was chosen");
    check(await painted(page, "#plot-speed"), "the camera's speed is not drawn");
    const { objects } = await (await page.request.get(`${url}frame/${kShown}.json`)).json();
    const info = await (await page.request.get(`${url}run.json`)).json(), canvas = page.locator("#image");
    const scale = (await canvas.boundingBox()).width / info.camera.width, [left, top, right, bottom] = objects[0].box;
    await canvas.click({ position: { x: (left + right) / 2 * scale, y: (top + bottom) / 2 * scale } });
    check(await page.locator("#history-title").textContent() === `History of #${objects[0].id}`, "not its history");
    check((await page.locator("#now-speed").textContent()).startsWith(objects[0].speed.toFixed(2)), "not its speed");
    check(await painted(page, "#plot-speed"), "the plot is empty");
    await page.keyboard.press("Escape");
    check(await page.locator("#history-title").textContent() === "History of the camera", "Escape does not let go of it");
  }));
  await test("keys step, play and pause", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kShown);
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("ArrowRight");
    await reaches(page, kShown + 1);
    await page.keyboard.press("ArrowLeft");
    await page.waitForFunction((wanted) => document.body.dataset.frame === String(wanted), kShown);
    await page.keyboard.press("Space");
    await reaches(page, kShown + 4);
    await page.keyboard.press("Space");
    check(await page.locator("#play").textContent() === "Play", "it still plays");
  }));
  await test("after the slider was touched Space plays, and arrows still move the slider", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kShown);
    const box = await page.locator("#scrub").boundingBox();
    await page.mouse.click(box.x + box.width / 4, box.y + box.height / 2);
    check(await page.evaluate(() => document.activeElement.id) === "scrub", "the slider does not have the focus");
    await page.waitForFunction(() => document.body.dataset.frame === document.getElementById("scrub").value);
    const from = await shown(page);
    await page.keyboard.press("ArrowRight");
    await shows(page, from + 1);
    await page.keyboard.press("Space");
    await reaches(page, from + 4);
    check(await page.locator("#play").textContent() === "Pause", "it does not play");
    await page.keyboard.press("Space");
    check(await page.locator("#play").textContent() === "Play", "it still plays");
  }));
  await test("percentiles of a finished run are those of all its frames, at frame 0, too", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const { timing } = await (await page.request.get(`${url}overview.json`)).json();
    const facts = await page.locator("#percentiles div").evaluateAll((groups) => groups.map((group) => [group.firstChild.textContent, group.lastChild.textContent]));
    for (const name of ["p50", "p99", "max"])
      check(facts.find(([fact]) => fact === name)[1] === timing[name].toFixed(1), `${name} is ${facts}, all frames give ${timing[name]}`);
    check(timing.p99 > timing.p50, "all frames took the same");
  }));
  for (const [name, options] of Object.entries({
    page_desktop_light: { height: 960 }, page_desktop_dark: { height: 960, scheme: "dark" },
    page_phone_light: { width: 390, height: 844, phone: true }, page_phone_dark: { width: 390, height: 844, phone: true, scheme: "dark" } })) {
    await test(`${name} fits and has its colors`, () => withPage(browser, { url, ...options }, async (page) => {
      await goTo(page, kShown);
      await page.locator("#objects tbody button").first().click();
      await checkWidth(page);
      const ground = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0]);
      check(options.scheme === "dark" ? ground < 60 : ground > 200, `the ground is ${ground}`);
      await page.waitForTimeout(500);
      await screenshot(page, name, { fullPage: Boolean(options.phone) });
    }));
  }
  await test("Ctrl-C ends the server in order", async () => {
    const code = await server.end();
    check(code === 0, `it ended with ${code}`);
  });
}

async function live(browser) {
  await test("a run is followed, held, stepped and seen to its end", async () => {
    const server = await start(["run", long, "--out", join(folder, "live"), "--rate", "4", "--view", "127.0.0.1:0"], kUrl);
    await withPage(browser, { url: server.found, ends: true }, async (page) => {
      await reaches(page, 3);
      const before = await shown(page);
      await reaches(page, before + 3);
      check(await painted(page, "#image"), "the image is empty");
      await page.locator("#play").click();
      await page.waitForFunction(() => document.getElementById("run-state").textContent === "paused");
      await page.waitForTimeout(600);  // what was under way comes out
      const held = await shown(page);
      await page.waitForTimeout(500);
      check(await shown(page) === held, "it goes on while it is paused");
      await page.locator("#forth").click();
      await page.waitForFunction((wanted) => document.body.dataset.frame === String(wanted), held + 1);
      await page.locator("#back").click();
      await page.waitForFunction((wanted) => document.body.dataset.frame === String(wanted), held);
      await page.locator("#play").click();
      await reaches(page, held + 3);
      const metrics = await (await page.request.get(`${server.found.replace(/#.*/, "")}metrics`)).text();
      check(/^motorcade_viewers 1$/m.test(metrics), "the metrics do not count this viewer");
      await page.waitForFunction(() => document.getElementById("run-state").textContent.startsWith("ended"));
    });
    check(await server.ended === 0, "the run failed");
  });
  await test("a run that is held ends with Ctrl-C", async () => {
    const server = await start(["run", long, "--out", join(folder, "held"), "--rate", "4", "--view", "127.0.0.1:0"], kUrl);
    await withPage(browser, { url: server.found, ends: true }, async (page) => {
      await reaches(page, 2);
      await page.locator("#play").click();
      await page.waitForFunction(() => document.getElementById("run-state").textContent === "paused");
      const code = await server.end();
      check(code === 130, `it ended with ${code}`);
    });
  });
}

try {
  await run(["synth", drive, "--scene", process.env.MOTORCADE_SCENE || "overtake", "-q"]);
  await run(["synth", long, "--scene", "lead", "--size", "621x187", "-q"]);
  await run(["run", drive, "--out", results, "--masks", "-q", "--rate", "10"]);
  await withBrowser(async (browser) => {
    await recorded(browser);
    await live(browser);
  });
} finally {
  rmSync(folder, { recursive: true, force: true });
}
