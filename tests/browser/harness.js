// What the tests of all pages share: a headless Chromium, pages that must not complain, programs that are started and ended.
import { spawn } from "node:child_process";
import { chromium } from "playwright-core";

export const kProgram = process.env.MOTORCADE_PROGRAM;
export const kScreenshots = process.env.MOTORCADE_SCREENSHOTS || "";
const kPatience_ms = Number(process.env.MOTORCADE_PATIENCE_MS || 120_000);  // more where a machine is busy

export function check(condition, sentence) {
  if (!condition) throw new Error(sentence);
}

export async function withBrowser(use) {
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"],
  });
  try {
    await use(browser);
  } finally {
    await browser.close();
  }
}

// Opens a page, and fails where it wrote an error to the console, threw one, or asked another server for anything.
export async function withPage(browser, options, use) {
  const { url, ends = false, width = 1440, height = 900, scheme = "light", phone = false } = options;
  const context = await browser.newContext({
    viewport: { width, height }, colorScheme: scheme, deviceScaleFactor: phone ? 2 : 1, isMobile: phone, hasTouch: phone });
  const page = await context.newPage(), complaints = [];
  const origin = url.startsWith("file:") ? url : new URL(url).origin;
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(error.stack || String(error)));
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(origin)) complaints.push(`asked ${request.url()}`);
  });
  page.setDefaultTimeout(kPatience_ms);
  try {
    await page.goto(url);
    await use(page);
    // Where the server ends before the page, what was under way cannot be loaded.
    if (ends) complaints.splice(0, complaints.length, ...complaints.filter((text) => !/Failed to load resource: net::ERR_/.test(text)));
    check(complaints.length === 0, `the page complained: ${complaints.join("; ")}`);
  } finally {
    await context.close();
  }
}

// As JPEG, or as PNG where the environment says MOTORCADE_SCREENSHOT_TYPE=png.
export async function screenshot(page, name, options = {}) {
  const png = process.env.MOTORCADE_SCREENSHOT_TYPE === "png";
  const kind = png ? { path: `${kScreenshots}/${name}.png`, type: "png" } : { path: `${kScreenshots}/${name}.jpg`, type: "jpeg", quality: 82 };
  if (kScreenshots) await page.screenshot({ ...kind, ...options });
}

// What is wider than the card that holds it, but for what scrolls in a box of its own.
const outsideOf = () => [...document.querySelectorAll(".card, figure, .finding")].flatMap((card) => {
  const { left, right, width } = card.getBoundingClientRect();
  if (width === 0) return [];
  return [...card.querySelectorAll("*")].filter((part) => {
    const box = part.getBoundingClientRect();
    return box.width > 0 && (box.right > right + 1 || box.left < left - 1) && !part.closest(".scroll, .wide, pre, svg, .label, #cursor, .mark, .bar");
  }).map((part) => `${part.localName}#${part.id}.${part.className} leaves ${card.id || card.className}`);
});

// The page is no wider than the screen, and nothing wider than its card, once all has its new size.
export async function checkWidth(page, where = "") {
  const problems = async () => {
    const [content, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
    return [...(content > screen ? [`the page is ${content} px wide on a screen of ${screen} px`] : []), ...await page.evaluate(outsideOf)];
  };
  let found = await problems();
  for (let i = 0; i < 15 && found.length > 0; ++i) {
    await page.waitForTimeout(200);
    found = await problems();
  }
  check(found.length === 0, `${where} ${found.slice(0, 4).join("; ")}`);
}

// What a finished run and one that goes on print.
export const kUrl = /http:\/\/[^\s]+/;
export const shown = (page) => page.evaluate(() => Number(document.body.dataset.frame ?? -1));
export const shows = (page, frame) => page.waitForFunction((wanted) => document.body.dataset.frame === String(wanted), frame);
export const reaches = (page, frame) => page.waitForFunction((wanted) => Number(document.body.dataset.frame ?? -1) >= wanted, frame);

// Moves the slider of the live page.
export async function goTo(page, frame) {
  await page.waitForFunction(() => document.body.dataset.frame !== undefined);
  await page.evaluate((to) => {
    const scrub = document.getElementById("scrub");
    scrub.value = to;
    scrub.dispatchEvent(new Event("input"));
  }, frame);
  await shows(page, frame);
}

// Starts the program and waits until it has printed what the pattern finds; `end` interrupts it and gives its exit code.
export async function start(args, pattern) {
  const child = spawn(kProgram, args, { stdio: ["ignore", "pipe", "pipe"] });
  let text = "";
  const ended = new Promise((resolve) => child.on("exit", (code) => resolve(code)));
  const found = new Promise((resolve, reject) => {
    const read = (part) => {
      text += part;
      const match = text.match(pattern);
      if (match) resolve(match[0]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    ended.then((code) => reject(new Error(`${args.join(" ")} ended with ${code}: ${text}`)));
    setTimeout(() => reject(new Error(`${args.join(" ")} printed no ${pattern}: ${text}`)), kPatience_ms).unref();
  });
  const end = async () => {
    if (child.exitCode === null) child.kill("SIGINT");
    const late = setTimeout(() => child.kill("SIGKILL"), kPatience_ms);
    const code = await ended;
    clearTimeout(late);
    return code;
  };
  try {
    return { found: await found, end, ended };
  } catch (error) {
    child.kill("SIGKILL");
    throw error;
  }
}

// Runs the program to its end.
export async function run(args) {
  const child = spawn(kProgram, args, { stdio: ["ignore", "ignore", "inherit"] });
  const code = await new Promise((resolve) => child.on("exit", resolve));
  check(code === 0, `motorcade ${args.join(" ")} ended with ${code}`);
}

// MOTORCADE_TESTS is a pattern of the names of those to do, all when empty.
export async function test(name, use) {
  if (!new RegExp(process.env.MOTORCADE_TESTS || "").test(name)) return;
  const begin = Date.now();
  try {
    await use();
    console.log(`ok   ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
  } catch (error) {
    console.log(`FAIL ${name}: ${error.message}`);
    process.exitCode = 1;
  }
}
