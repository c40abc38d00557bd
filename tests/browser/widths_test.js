// No page scrolls sideways, from a small phone to a wide screen, in light and dark: the live page of one run and of two,
// the report with its times, the page of a batch and that of a check.
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { check, checkWidth, goTo, kUrl, reaches, run, screenshot, start, test, withBrowser, withPage } from "./harness.js";

const folder = mkdtempSync(join(tmpdir(), "motorcade_browser_"));
const drive = join(folder, "a_drive_with_a_name_that_is_rather_long_for_a_phone"), results = join(folder, "run"), other = join(folder, "other");
const kWidths = [360, 768, 1024, 1280, 1366, 1440, 1920, 2560], kPictures = { 390: "phone", 1280: "desktop" };

async function atAllWidths(browser, name, url, prepare, ends = false) {
  for (const scheme of ["light", "dark"])
    await test(`${name}, ${scheme}: from ${kWidths[0]} to ${kWidths[kWidths.length - 1]} px it does not scroll sideways`, () => withPage(browser, { url, scheme, ends }, async (page) => {
      await prepare?.(page);
      for (const width of [390, ...kWidths]) {
        await page.setViewportSize({ width, height: width < 700 ? 844 : 900 });
        await page.waitForTimeout(150);
        await checkWidth(page, `at ${width} px`);
        if (kPictures[width]) await screenshot(page, `${name}_${kPictures[width]}_${scheme}`, { fullPage: true });
      }
    }));
}

async function served(browser, name, args, prepare) {
  const server = await start([...args, "--view", "127.0.0.1:0"], kUrl);
  await atAllWidths(browser, name, server.found, prepare, true);
  await server.end();
}

async function files(browser) {
  const page_of = (file) => pathToFileURL(file).href;
  await run(["report", results, "-q"]);
  await atAllWidths(browser, "report", page_of(join(results, "report.html")), async (page) => {
    await page.evaluate(() => { for (const details of document.querySelectorAll("details")) details.open = true; });
  });
  await test("on a phone the report says where a chart goes on", () => withPage(browser, { url: page_of(join(results, "report.html")), width: 390, height: 844, phone: true }, async (page) => {
    const [wide] = await page.locator(".wide").evaluateAll((all) => all.filter((box) => box.querySelector("svg")).map((box) => box.scrollWidth > box.clientWidth));
    check(wide === true, "the map fits anyway");
    check(await page.locator(".swipe").first().isVisible(), "nothing says that it goes on");
  }));
  await run(["check", drive, "--page", join(folder, "check.html")]);
  await atAllWidths(browser, "check", page_of(join(folder, "check.html")));
  const manifest = join(folder, "m.toml"), batch = join(folder, "batch"), before = join(folder, "before");
  writeFileSync(manifest, `[[drives]]\nname = "street"\npath = "${drive}"\n[sets.joint]\n[sets.pose_graph]\nbackend.kind = "pose_graph"\n`);
  for (const out of [before, batch]) await run(["batch", manifest, "--out", out, "-j", "1", "-q"]);
  await run(["batch", "merge", batch, "--against", before]);
  await atAllWidths(browser, "batch", page_of(join(batch, "merged", "report.html")));
}

try {
  await run(["synth", drive, "--scene", "overtake", "--size", "621x187", "--frames", "60", "-q"]);
  await run(["run", drive, "--out", results, "--masks", "-q", "--rate", "20"]);
  await run(["run", drive, "--out", other, "--inject", "black@20:26", "-q"]);
  await withBrowser(async (browser) => {
    await served(browser, "view", ["view", results], (page) => goTo(page, 20));
    await served(browser, "two", ["view", results, "--against", other], (page) => goTo(page, 20));
    await served(browser, "live", ["run", drive, "--out", join(folder, "live"), "--rate", "0.5"], (page) => reaches(page, 1));
    await files(browser);
  });
} finally {
  rmSync(folder, { recursive: true, force: true });
}
