// The page that `motorcade report` writes.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { check, checkWidth, run, screenshot, test, withBrowser, withPage } from "./harness.js";

const folder = mkdtempSync(join(tmpdir(), "motorcade_browser_"));
const scene = process.env.MOTORCADE_SCENE || "overtake";
const drive = join(folder, scene), results = join(folder, "run");

const kLooks = {
  report_desktop_light: {}, report_desktop_dark: { scheme: "dark" },
  report_phone_light: { width: 390, height: 844, phone: true }, report_phone_dark: { width: 390, height: 844, phone: true, scheme: "dark" } };

try {
  await run(["synth", drive, "--scene", scene, "-q"]);
  await run(["run", drive, "--out", results, "--masks", "-q", "--rate", "10"]);
  await run(["report", results, "-q"]);
  const url = pathToFileURL(join(results, "report.html")).href;
  await withBrowser(async (browser) => {
    for (const [name, options] of Object.entries(kLooks)) {
      await test(`${name} fits and has its colors`, () => withPage(browser, { url, ...options }, async (page) => {
        await checkWidth(page);
        const ground = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0]);
        check(options.scheme === "dark" ? ground < 60 : ground > 200, `the ground is ${ground}`);
        check(await page.locator("svg").count() >= 4, "charts are missing");
        const empty = await page.evaluate(() => [...document.images].filter((image) => image.naturalWidth === 0).length);
        check(empty === 0, `${empty} pictures are empty`);
        check(await page.evaluate(() => document.images.length) > 0, "there is no picture");
        await screenshot(page, name, { fullPage: false });
        await screenshot(page, `${name}_whole`, { fullPage: true });
      }));
    }
    await test("it can be printed", () => withPage(browser, { url, scheme: "dark" }, async (page) => {
      await page.emulateMedia({ media: "print", colorScheme: "dark" });
      const ground = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number)[0]);
      check(ground > 200, `paper is printed on dark ground: ${ground}`);
    }));
  });
} finally {
  rmSync(folder, { recursive: true, force: true });
}
