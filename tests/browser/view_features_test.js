// What a researcher looks for on the page of a finished run: truth, worst frames, marks, tracks, links, a second run.
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, checkWidth, goTo, kUrl, run, screenshot, shown, shows, start, test, withBrowser, withPage } from "./harness.js";

const folder = mkdtempSync(join(tmpdir(), "motorcade_browser_"));
const drive = join(folder, "drive"), results = join(folder, "run"), other = join(folder, "other"), faulty = join(folder, "faulty");
const kFrame = 20;

const json = async (page, url) => (await page.request.get(url)).json();
const pixels = (page, selector) => page.locator(selector).evaluate((canvas) => canvas.toDataURL());
const hash = (page) => page.evaluate(() => location.hash);
const hasHash = (page, wanted) => page.waitForFunction((text) => location.hash === text, wanted);

async function truthAndErrors(browser, url) {
  await test("the truth lies over image and scene, and can be taken away", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kFrame);
    const with_truth = await pixels(page, "#image");
    check(await page.locator("#truth").getAttribute("aria-pressed") === "true", "the truth is not shown");
    await page.keyboard.press("t");
    check(await page.locator("#truth").getAttribute("aria-pressed") === "false", "the truth is still shown");
    const without = await pixels(page, "#image");
    check(with_truth !== without, "the image is the same without the truth");
    await page.locator("#truth").click();
    check(await pixels(page, "#image") !== without, "the truth does not come back");
  }));
  await test("errors of the frame stand in list and timeline as the server has them", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kFrame);
    const { truth } = await json(page, `${url}frame/${kFrame}.json`), overview = await json(page, `${url}overview.json`);
    const value = (name) => page.locator(`.curve[data-name="${name}"] output`).textContent();
    const position = truth.position_m.toFixed(3), highest = Math.max(...overview.truth.position_m).toFixed(3);
    check(await value("camera position error") === `${position} m  (max ${highest})`, `it says ${await value("camera position error")}, not ${position}`);
    check((await value("camera motion error")).startsWith(truth.step_m.toFixed(4)), "not the error of the camera's motion");
    const matched = truth.objects.filter(({ track }) => track !== undefined);
    check(matched.length > 0, "no object of the drive has a label");
    for (const { track, off_m } of matched) {
      const cell = await page.locator(`#objects tr[data-id="${track}"] td`).nth(4).textContent();
      check(cell === off_m.toFixed(2), `object ${track} is ${cell} off, not ${off_m}`);
    }
  }));
  await test("curves are painted and lead to the frame under the pointer", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const box = await page.locator("#curves").boundingBox(), last = Number(await page.locator("#scrub").getAttribute("max"));
    await page.mouse.click(box.x + 8 + (box.width - 16) / 2, box.y + 20);
    await shows(page, Math.round(last / 2));
    const inks = await page.locator(".curve canvas").evaluateAll((all) => all.map((canvas) =>
      new Set(new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size));
    check(inks.length >= 3 && inks.every((colors) => colors > 2), `curves of ${inks} colors`);
  }));
}

async function worstFrames(browser, url) {
  await test("a click on a worst frame goes there, and back leads back", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kFrame);
    await hasHash(page, `#frame=${kFrame}`);
    const { worst } = await json(page, `${url}overview.json`);
    const listed = await page.locator("#worst button").evaluateAll((all) => all.map((button) => Number(button.dataset.frame)));
    check(listed[0] === worst.camera[0].frame, `the first is ${listed[0]}, the worst ${worst.camera[0].frame}`);
    check(worst.objects.every(({ frame }, i) => i >= 8 || listed.includes(frame)), "errors of objects are missing");
    await page.locator("#worst button").first().click();
    await shows(page, worst.camera[0].frame);
    check(await page.locator("#worst button").first().getAttribute("aria-current") === "true", "it is not marked");
    await page.goBack();
    await shows(page, kFrame);
    await page.goForward();
    await shows(page, worst.camera[0].frame);
  }));
  await test("a worst frame of an object chooses it", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kFrame);
    const [{ frame, track }] = (await json(page, `${url}overview.json`)).worst.objects;
    await page.locator(`#worst button[aria-label^="frame ${frame}, Object"]`).click();
    await shows(page, frame);
    check(await page.locator("#history-title").textContent() === `History of #${track}`, "its object is not chosen");
  }));
}

async function marks(browser) {
  const server = await start(["view", faulty, "--view", "127.0.0.1:0"], kUrl), url = server.found;
  await test("lost and degraded frames are marked on the timeline", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const expected = (await json(page, `${url}overview.json`)).marks;
    check(expected.some(({ status }) => status === "lost") && expected.some(({ status }) => status === "degraded"), "the drive lost nothing");
    const found = await page.locator("#marks .mark").evaluateAll((all) => all.map((mark) => [mark.className, mark.title]));
    check(found.length === expected.length, `${found.length} marks of ${expected.length}`);
    expected.forEach(({ status, from }, i) => check(found[i][0] === `mark ${status}` && found[i][1].includes(String(from)), `${found[i]} is not ${status}`));
    const legend = await page.locator("#marks-legend").textContent();
    const lost = expected.filter(({ status }) => status === "lost").reduce((sum, { from, to }) => sum + to - from + 1, 0);
    check(legend.includes(`${lost} lost`), `the legend says ${legend}`);
    const box = await page.locator("#marks .mark.lost").first().boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForFunction(() => document.getElementById("tracking").textContent.startsWith("lost"));
    await screenshot(page, "page_lost_light");
  }));
  await server.end();
}

async function tracksOverTime(browser, url) {
  await test("every track has a row with its spans; a click goes there and chooses it", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const { tracks, frames } = await json(page, `${url}overview.json`);
    const names = await page.locator("#tracks li:not(.label-row) .name").evaluateAll((all) => all.map((name) => name.firstChild.textContent));
    check(JSON.stringify(names) === JSON.stringify(tracks.map(({ id }) => `#${id}`)), `rows ${names}`);
    const track = tracks.reduce((a, b) => (b.spans[0][0] > a.spans[0][0] ? b : a)), [from, to] = track.spans[0];
    const bar = page.locator("#tracks li:not(.label-row)").nth(tracks.indexOf(track)).locator(".bar"), box = await bar.boundingBox();
    const wanted = Math.round((from + to) / 2);
    await page.mouse.click(box.x + box.width * wanted / (frames - 1), box.y + box.height / 2);
    await page.waitForFunction((near) => Math.abs(Number(document.body.dataset.frame) - near) <= 1, wanted);
    check(await page.locator("#history-title").textContent() === `History of #${track.id}`, "it is not chosen");
  }));
  await test("by keys a track's row leads to its first frame", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const { tracks } = await json(page, `${url}overview.json`), track = tracks[tracks.length - 1];
    await page.locator("#tracks li:not(.label-row) button").nth(tracks.length - 1).focus();
    await page.keyboard.press("Enter");
    await shows(page, track.spans[0][0]);
  }));
  await test("labels stand in rows of their own", () => withPage(browser, { url }, async (page) => {
    await goTo(page, 0);
    const { truth } = await json(page, `${url}overview.json`);
    check(truth.labels.length > 0, "the drive has no labels that move");
    check(await page.locator("#tracks .label-row").count() === truth.labels.length, "labels are missing");
  }));
}

async function links(browser, url) {
  await test("a link leads to its frame and object", () => withPage(browser, { url: `${url}#frame=12&object=1` }, async (page) => {
    await shows(page, 12);
    check(await page.locator("#history-title").textContent() === "History of #1", "the object is not chosen");
    await page.evaluate(() => { location.hash = "#frame=7"; });
    await shows(page, 7);
    await page.goBack();
    await shows(page, 12);
  }));
  await test("a link beyond the end leads to the last frame", () => withPage(browser, { url: `${url}#frame=99999` }, async (page) => {
    await page.waitForFunction(() => document.body.dataset.frame !== undefined);
    check(await shown(page) === Number(await page.locator("#scrub").getAttribute("max")), "not the last frame");
  }));
  await test("the address follows the frame, and is copied", () => withPage(browser, { url }, async (page) => {
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await goTo(page, 5);
    await hasHash(page, "#frame=5");
    await page.locator("#forth").click();
    await hasHash(page, "#frame=6");
    await page.locator("#copy-link").click();
    await page.waitForFunction(() => document.getElementById("copy-link").textContent === "Copied");
    check(await page.evaluate(() => navigator.clipboard.readText()) === `${url}#frame=6`, "another text was copied");
    await page.locator("#map").click({ position: { x: 20, y: 60 } });
    await page.waitForFunction(() => location.hash !== "#frame=6");
    await page.goBack();
    await shows(page, 6);
  }));
}

async function twoRuns(browser) {
  const server = await start(["view", results, "--against", other, "--view", "127.0.0.1:0"], kUrl), url = server.found;
  await test("two runs are shown in the same frame, with how far they are apart", () => withPage(browser, { url }, async (page) => {
    await goTo(page, kFrame);
    const [a, b] = [await json(page, `${url}frame/${kFrame}.json`), await json(page, `${url}against/frame/${kFrame}.json`)];
    const apart = Math.hypot(...[3, 7, 11].map((i) => a.T[i] - b.T[i])).toFixed(3);
    check((await page.locator("#apart").textContent()).startsWith(`Cameras ${apart} m`), `not ${apart} m apart`);
    check((await page.locator('.curve[data-name="cameras apart"] output').textContent()).match(/^\d+\.\d+ m/), "no curve of the distance");
    const text = await page.locator("#difference-values").textContent();
    check(text.includes(a.truth.position_m.toFixed(3)) && text.includes(b.truth.position_m.toFixed(3)), "errors of both are missing");
    check(await page.locator("#difference-objects tbody tr").count() > 0, "no object is the same");
    check(await page.locator("#image-other").isVisible() && await pixels(page, "#image-other") !== await pixels(page, "#image"), "no second image");
    check((await page.locator("#other-name").textContent()) === other, "the other run is not named");
    await page.keyboard.press("ArrowRight");
    await shows(page, kFrame + 1);
    const [c, d] = [await json(page, `${url}frame/${kFrame + 1}.json`), await json(page, `${url}against/frame/${kFrame + 1}.json`)];
    check((await page.locator("#apart").textContent()).startsWith(`Cameras ${Math.hypot(...[3, 7, 11].map((i) => c.T[i] - d.T[i])).toFixed(3)} m`), "it does not go on with the frame");
  }));
  for (const [name, options] of Object.entries({ two_desktop_light: { width: 1280 }, two_desktop_dark: { width: 1280, scheme: "dark" },
    two_phone_light: { width: 390, height: 844, phone: true }, two_phone_dark: { width: 390, height: 844, phone: true, scheme: "dark" } }))
    await test(`${name} fits`, () => withPage(browser, { url, ...options }, async (page) => {
      await goTo(page, kFrame);
      await checkWidth(page);
      await page.waitForTimeout(500);
      await screenshot(page, name, { fullPage: true });
    }));
  await server.end();
}

async function holding(browser) {
  const server = await start(["run", drive, "--out", join(folder, "live"), "--rate", "1", "--view", "127.0.0.1:0"], kUrl);
  const [plain, token] = server.found.split("#token=");
  await test("only a page with the printed address can hold the run", async () => {
    check(/^[0-9a-f]{32}$/.test(token), `the printed address is ${server.found}`);
    await withPage(browser, { url: plain, ends: true }, async (page) => {
      await page.waitForFunction(() => document.body.dataset.frame !== undefined);
      check(await page.locator("#play").isDisabled(), "it may hold the run");
      check(!(await (await page.request.get(`${plain}run.json`)).text()).includes(token), "run.json tells the token");
      check((await page.request.get(`${plain}control/pause`)).status() === 403, "a call without token holds the run");
    });
    await withPage(browser, { url: server.found, ends: true }, async (page) => {
      await page.waitForFunction(() => document.body.dataset.frame !== undefined);
      check(await hash(page) === "", "the token stays in the address");
      await page.locator("#play").click();
      await page.waitForFunction(() => document.getElementById("run-state").textContent === "paused");
      await page.reload();
      await page.waitForFunction(() => document.body.dataset.frame !== undefined);
      check(!await page.locator("#play").isDisabled(), "after a reload it may not hold the run");
      await page.locator("#play").click();
      await page.waitForFunction(() => document.getElementById("run-state").textContent === "live");
    });
  });
  await server.end();
}

try {
  await run(["synth", drive, "--scene", "overtake", "--size", "621x187", "--frames", "60", "-q"]);
  await run(["run", drive, "--out", results, "--masks", "-q", "--rate", "20"]);
  const config = join(folder, "other.toml");
  writeFileSync(config, '[backend]\nkind = "pose_graph"\n');
  await run(["run", drive, "--out", other, "--config", config, "-q"]);
  await run(["run", drive, "--out", faulty, "--inject", "black@20:26", "-q"]);
  await withBrowser(async (browser) => {
    const server = await start(["view", results, "--view", "127.0.0.1:0"], kUrl), url = server.found;
    await truthAndErrors(browser, url);
    await worstFrames(browser, url);
    await tracksOverTime(browser, url);
    await links(browser, url);
    await server.end();
    await marks(browser);
    await twoRuns(browser);
    await holding(browser);
  });
} finally {
  rmSync(folder, { recursive: true, force: true });
}
