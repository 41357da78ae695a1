// Draws the pictures of docs/how-it-works.md: from traces of searches, which `sim3align-lab trace` wrote, and with the package.
import { createAligner } from "sim3align";
import { readCase, readDepth, readMask } from "sim3align/formats.js";
import { classes, explained, figure, legend, maskBox, observed } from "./cells.js";
import { bars, chart } from "./chart.js";
import { drawScene } from "./how-it-works-scene.js";

const [TEAL, GREY, RED, BLUE] = ["#16827a", "#b5bac2", "#d73c32", "#2f6fd0"];
const trace = async (name) => (await fetch(`/target/pictures/${name}.json`)).json();
const [mug, wide, wrong, box] = await Promise.all(["mug", "wide", "wrong", "box"].map(trace));
const aligner = await createAligner();

/** Adds a picture, which is written to a file of this name. */
function picture(name, ...parts) {
  const main = document.createElement("main");
  main.id = name;
  main.append(...parts);
  document.body.append(main);
}

const score = ({ score }) => score.total.toFixed(2);
const fine = (image, high = 200) => explained(mug.grids.fine, image.z, high);

/** What a pixel says. */
function drawEvidence() {
  const start = mug.refinement.images[0];
  picture(
    "evidence",
    figure(observed(mug.grids.fine, 200), "observed: depth, mask"),
    figure(fine(start), `a pose that is ${start.angle.toFixed(0)}° off: ${score(start)}`),
    figure(fine(mug.best), `the best pose: ${score(mug.best)}`),
    legend(classes),
  );
}

/** The rotation grid: some of its images, and the scores of all. */
function drawSieve() {
  const { points, images } = mug.sieve;
  const shown = document.createElement("div");
  shown.style.cssText = "display: grid; grid-template-columns: repeat(3, auto); gap: 8px";
  shown.append(figure(observed(mug.grids.sieve, 112), "observed"));
  for (const { rank, image } of images) {
    shown.append(figure(explained(mug.grids.sieve, image.z, 112), `rank ${rank}: ${score(image)}`));
  }
  const kept = mug.rounds[1].points.length;
  const plot = chart({
    ...{ width: 410, height: 270 },
    x: {
      from: 0,
      to: 180,
      ticks: [0, 45, 90, 135, 180],
      label: "rotation from the pose that is found in the end, degrees",
    },
    y: { from: 0.2, to: 1.1, ticks: [0.2, 0.4, 0.6, 0.8, 1], label: "score" },
    layers: [
      { points: points.slice(kept), colour: GREY },
      { points: points.slice(0, kept), colour: TEAL },
    ],
    notes: [{ at: [176, 1.02], text: `${points.length} rotations, ${kept} go on`, colour: TEAL, anchor: "end" }],
  });
  picture("sieve", shown, plot);
}

/** The poses with which each round begins. */
function drawRounds() {
  const names = ["place", "refine", "refine again", "rank"];
  const panels = mug.rounds
    .filter(({ name }) => names.includes(name))
    .map(({ name, points }) =>
      figure(
        chart({
          ...{ width: 190, height: 170 },
          x: { from: 0, to: 180, ticks: [0, 90, 180], label: "degrees from the result" },
          y: { from: 0.5, to: 2, ticks: [0.5, 1, 1.5, 2], label: "" },
          layers: [{ points, colour: TEAL, size: 2.5 }],
        }),
        `${name}: ${points.length} poses`,
      ),
    );
  picture("rounds", ...panels);
}

/** One refinement. */
function drawRefinement() {
  const { points, images } = mug.refinement;
  const steps = points.map(([, total], k) => [k, total]);
  const plot = chart({
    ...{ width: 270, height: 195 },
    x: { from: 0, to: 12, ticks: [0, 4, 8, 12], label: "steps" },
    y: { from: 1, to: 1.6, ticks: [1, 1.2, 1.4, 1.6], label: "score" },
    layers: [
      { line: steps, colour: TEAL },
      { points: steps, colour: TEAL, size: 3 },
    ],
  });
  const shown = [images[0], images[2], images.at(-1)];
  const captions = ["start", "after 2 steps", "after 12 steps"];
  const figures = shown.map((image, k) => figure(fine(image, 168), `${captions[k]}: ${image.angle.toFixed(0)}° off`));
  picture("refinement", plot, ...figures);
}

/** A mesh that is a tenth too long along one axis. */
function drawProportions() {
  const { similar, stretched, fitted } = wide.proportions;
  const grid = wide.grids.fine;
  const rows = ["x", "y", "z"].flatMap((axis, k) => {
    const right = k === 0 ? 1.1 ** (-2 / 3) : 1.1 ** (1 / 3);
    const row = (name, value) => ({ name, share: (value - 0.9) / 0.2, text: `× ${value.toFixed(3)}` });
    return [row(`${axis} fitted`, fitted.stretch[k][k]), row(`${axis} right`, right)];
  });
  const lengths = bars({ width: 300, colour: TEAL, rows });
  picture(
    "proportions",
    figure(explained(grid, similar.z, 190), `as a similarity: ${score(similar)}`),
    figure(explained(grid, stretched.z, 190), `stretched: ${score(stretched)}`),
    figure(lengths, "factors of the lengths, × 0.9 to × 1.1"),
  );
}

/** Shape and colour of a box that rolls. */
async function drawColour() {
  const step = 360 / box.rolls.length;
  const line = (k, per) => box.rolls.map((point, i) => [i * step, (point[k] ?? 0) / per]);
  const plot = chart({
    ...{ width: 600, height: 205 },
    x: {
      from: 0,
      to: 360,
      ticks: [0, 90, 180, 270, 360],
      label: "roll of the best pose about an axis of the box, degrees",
    },
    y: { from: 0, to: 2, ticks: [0, 1, 2], label: "" },
    layers: [
      { line: line(0, 1), colour: BLUE },
      { line: line(1, 1), colour: RED },
    ],
    notes: [
      { at: [196, 1.85], text: "score of the shape", colour: BLUE },
      { at: [134, 0.56], text: "correlation of the colours", colour: RED },
    ],
  });
  const photo = await createImageBitmap(await (await fetch("/target/pictures/box/rgb.png")).blob());
  const mask = await createImageBitmap(await (await fetch("/target/pictures/box/mask.png")).blob());
  picture("colour", figure(cut(photo, mask), "the box in the photo"), plot);
}

/** The part of a photo around its mask. */
function cut(photo, mask) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [mask.width, mask.height];
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(mask, 0, 0);
  const { data } = context.getImageData(0, 0, mask.width, mask.height);
  const sides = maskBox(mask.width, mask.height, (i) => data[4 * i] > 0);
  const [low, high] = [sides.map(([first]) => first - 12), sides.map(([, last]) => last + 12)];
  const [width, height] = [0, 1].map((k) => high[k] - low[k]);
  const part = document.createElement("canvas");
  [part.width, part.height] = [width, height];
  part.style.height = "165px";
  part.getContext("2d").drawImage(photo, low[0], low[1], width, height, 0, 0, width, height);
  return part;
}

/** The six numbers of the confidence, of the right mesh and of a wrong one. */
function drawConfidence() {
  const panel = (name, { best, grids, confidence, lead, uncertainty }, colour) => {
    const { overlap, depth, outline } = best.score;
    const { scale, rotationDeg } = uncertainty;
    const firm = (x, [low, high]) => 1 - Math.log(Math.max(x, low) / low) / Math.log(high / low);
    const rows = [
      { name: "overlap", share: overlap, text: overlap.toFixed(2) },
      { name: "depth", share: depth, text: depth.toFixed(2) },
      { name: "outline", share: outline, text: outline.toFixed(2) },
      { name: "lead", share: lead, text: `${lead.toFixed(2)}` },
      { name: "scale known to", share: firm(scale, [1e-3, 1]), text: `${(100 * scale).toFixed(1)} %` },
      { name: "rotation known to", share: firm(rotationDeg, [0.03, 90]), text: `${rotationDeg.toFixed(1)}°` },
    ];
    const both = document.createElement("div");
    both.style.cssText = "display: flex; gap: 10px; align-items: center";
    both.append(explained(grids.fine, best.z, 128), bars({ width: 256, rows, colour }));
    return figure(both, `${name}: confidence ${confidence.toFixed(2)}`);
  };
  picture("confidence", panel("its own mesh", mug, TEAL), panel("the mesh of a teapot", wrong, RED));
}

/** The score by the relief that a shift gives to the object. */
async function drawRelief() {
  const names = ["depth.png", "mask.png", "camera.json", "mesh.glb"];
  const files = await Promise.all(
    names.map(async (name) => [name, new Uint8Array(await (await fetch(`/www/samples/mug/${name}`)).arrayBuffer())]),
  );
  const { input } = await readCase(Object.fromEntries(files));
  const { data, width, height } = await readDepth(files[0][1], { depthScale: 1e-4 });
  const mask = await readMask(files[1][1]);
  const own = data.filter((z, i) => z > 0 && mask.data[i]).sort();
  const middle = own[own.length >> 1];
  const curve = [];
  for (const relief of [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.25, 1.4, 1.6, 1.8, 2]) {
    const depth = data.map((z) => (z > 0 ? Math.max(0, middle + relief * (z - middle)) : 0));
    const { diagnostics } = await aligner.align(
      { ...input, depth, width, height, mask },
      { metrics: false, quality: "fast" },
    );
    curve.push([relief, diagnostics.score]);
  }
  const plot = chart({
    ...{ width: 780, height: 210 },
    x: { from: 0.4, to: 2, ticks: [0.5, 1, 1.5, 2], label: "relief of the depth map, relative to the true one" },
    y: { from: 1, to: 2, ticks: [1, 1.5, 2], label: "score" },
    layers: [
      { line: curve, colour: TEAL },
      { points: curve, colour: TEAL, size: 3 },
    ],
    notes: [
      { at: [0.42, 1.05], text: "too flat", colour: "#444" },
      { at: [1.98, 1.05], text: "too deep", colour: "#444", anchor: "end" },
    ],
  });
  picture("relief", plot);
}

drawEvidence();
drawSieve();
drawRounds();
drawRefinement();
drawProportions();
await drawColour();
drawConfidence();
await drawRelief();
await drawScene(aligner, picture);
document.body.dataset.state = "done";
