/** A page with the 3D view only, and helpers of its tests. */
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { before } from "node:test";
import { build } from "esbuild";
import type { Page } from "playwright-core";
import { browserFor, type PageTest, SOFTWARE, SOFTWARE_WEBGPU, WEBGL } from "./browser.js";
import { repository } from "./environment.js";
import { columnMajor } from "./scene.js";

export type Place = [number, number];
export type ViewEvent =
  | { kind: "pose"; id: string; pose: number[]; phase: string }
  | { kind: "select"; id: string | null }
  | { kind: "hover"; pixel: { x: number; y: number } | null };

/** The global that tests/support/view3d-harness.mjs defines in the page. */
interface Harness {
  viewEvents: ViewEvent[];
  camera: { fx: number; fy: number; cx: number; cy: number };
  width: number;
  height: number;
  quarters: [number, number, number][];
  object(id: string, colour: string, kind?: string | number[]): object;
  start(width: number, height: number, forceWebGL?: boolean): Promise<"webgpu" | "webgl">;
  show(display?: object): void;
  colours(places: Place[]): Promise<[number, number, number][]>;
  view: {
    setObjects(objects: object[]): Promise<void>;
    setPose(id: string, pose: number[]): Promise<void>;
    select(id: string | null): void;
    setGizmo(mode: string | null): void;
    setGround(plane: { normal: [number, number, number]; d: number }): void;
    lookFrom(which: string): void;
  };
}
declare global {
  var harness: Harness;
}

/** One per test file, because they run in parallel. */
const folder = join(repository, "target", "view3d-test", basename(process.argv[1] ?? ""));

/** A browser with WebGPU in software. */
export const withWebGpu = () => browserFor(folder, SOFTWARE_WEBGPU);

/** A browser with WebGL 2 only. */
export const withoutWebGpu = () => browserFor(folder, [...SOFTWARE, ...WEBGL, "--disable-blink-features=WebGPU"]);

before(async () => {
  mkdirSync(folder, { recursive: true });
  const html =
    '<!doctype html><link rel="icon" href="data:,"><title>3D</title><script type="module" src="harness.js"></script>';
  writeFileSync(join(folder, "index.html"), html);
  await build({
    entryPoints: [join(repository, "tests", "support", "view3d-harness.mjs")],
    ...{ bundle: true, format: "esm", outfile: join(folder, "harness.js"), logLevel: "error" },
    alias: {
      "sim3align/conventions": join(repository, "target", "compiled", "conventions"),
      "sim3align/input": join(repository, "target", "compiled", "input"),
      "sim3align/three": join(repository, "pkg", "three.js"),
    },
  });
});

/** Wider than the image, which therefore has bars at its sides. */
export const host = { width: 500, height: 300 };

/** The position of a pixel of the depth map on the page. The image is letterboxed. */
export function placeOf({ width, height }: Harness, u: number, v: number): Place {
  const scale = Math.min(host.width / width, host.height / height);
  return [(host.width - scale * width) / 2 + scale * (u + 0.5), (host.height - scale * height) / 2 + scale * (v + 0.5)];
}

/** A cube of 0.1 m with its centre, (3, 0, 0) in the frame of the mesh, at (x, y, 0.8) metres, in front of the wall. */
export const pose = (x: number, y: number, scale = 0.1) =>
  columnMajor({ scale, rotation: [0, 0, 0, 1], translation: [x - 3 * scale, y, 0.8] });

/** The pixel of a point of the camera frame. */
export const pixelOf = ({ camera }: Harness, x: number, y: number, z: number): Place => [
  (camera.fx * x) / z + camera.cx,
  (camera.fy * y) / z + camera.cy,
];

export const isNear = (found: readonly number[] | undefined, wanted: readonly number[], within = 4) =>
  assert.ok(
    found && wanted.every((tone, k) => Math.abs((found[k] ?? 999) - tone) <= within),
    `${found} is not near ${wanted}`,
  );
export const isGreen = ([r = 0, g = 0, b = 0]: readonly number[] = []) => g > 60 && g > 1.8 * r && g > 1.8 * b;

/** Opens a page with the harness, and returns its constants. */
export async function open(browser: PageTest): Promise<{ page: Page; errors: string[]; facts: Harness }> {
  const { page, errors } = await browser.open("index.html");
  page.setDefaultTimeout(120_000);
  await page.waitForFunction(() => "harness" in globalThis);
  const facts = (await page.evaluate(() => JSON.parse(JSON.stringify(harness)))) as Harness;
  return { page, errors, facts };
}

/** Opens a view of the wall from the camera, with a green cube: of one kind, or the bytes of a GLB. */
export async function openCube(browser: PageTest, forceWebGL = false, kind: string | number[] = "arrays") {
  const opened = await open(browser);
  const start = ([size, isForced]: [typeof host, boolean]) => harness.start(size.width, size.height, isForced);
  const backend = await opened.page.evaluate(start, [host, forceWebGL] as [typeof host, boolean]);
  const show = async ([kind, pose]: [string | number[], number[]]) => {
    harness.show();
    await harness.view.setObjects([harness.object("cube", "#00c040", kind)]);
    await harness.view.setPose("cube", pose);
  };
  await opened.page.evaluate(show, [kind, pose(0, 0)] as [string | number[], number[]]);
  const colours = (places: Place[]) => opened.page.evaluate((places) => harness.colours(places), places);
  return { ...opened, backend, colours };
}
