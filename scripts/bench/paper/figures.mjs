/** The figure page: one SVG with error against difficulty, histograms of IoU, and pictures of poses. */
import { isWithin, strict } from "../records.mjs";
import { median, share } from "../table.mjs";

/** @typedef {import("../records.mjs").BenchRecord} BenchRecord */
/** @typedef {{ method: string, records: readonly BenchRecord[] }} Series */
/** @typedef {{ title: string, png: Buffer, width: number, height: number }} Picture */
/** @typedef {import("vega-lite").TopLevelSpec} Spec */
/** @typedef {Extract<Spec, { hconcat: unknown }>["hconcat"][number]} Panel */

const difficultyBins = 5;
const panel = { width: 420, height: 240 };
const pictureWidth = 300;
const margin = 24;

/** The bin of a difficulty from 0 to 1. @param {number} difficulty */
const binOf = (difficulty) => Math.min(Math.floor(difficulty * difficultyBins), difficultyBins - 1);

/**
 * Success and median error of each method by the difficulty of the case.
 * @param {readonly Series[]} series
 */
export function byDifficulty(series) {
  return series.flatMap(({ method, records }) =>
    Array.from({ length: difficultyBins }, (_, bin) => {
      const members = records.filter(({ parameters }) => binOf(parameters.difficulty ?? Number.NaN) === bin);
      const errors = members.map(({ errors }) => errors);
      return {
        method,
        difficulty: (bin + 0.5) / difficultyBins,
        n: members.length,
        success: 100 * share(errors.map((error) => isWithin(error, strict))),
        rotationDeg: median(errors.map((error) => error?.rotationErrorDeg ?? 180)),
      };
    }).filter(({ n }) => n > 0),
  );
}

/**
 * The share of the cases of each method by IoU, in tenths; no answer counts as no overlap.
 * @param {readonly Series[]} series
 */
export function byOverlap(series) {
  return series.flatMap(({ method, records }) =>
    Array.from({ length: 10 }, (_, bin) => {
      const inBin = records.filter(
        ({ alignment }) => Math.min(Math.floor(10 * (alignment?.metrics.iou ?? 0)), 9) === bin,
      );
      return { method, from: bin / 10, to: (bin + 1) / 10, percent: (100 * inBin.length) / records.length };
    }),
  );
}

/**
 * @param {readonly Series[]} series
 * @param {readonly Picture[]} pictures in rows of three
 * @returns {Promise<string>} SVG
 */
export async function figurePage(series, pictures) {
  const methods = series.map(({ method }) => method);
  const [lines, overlap] = await Promise.all([
    chart(lineCharts({ values: byDifficulty(series) }, methods)),
    chart(histograms({ values: byOverlap(series) }, methods)),
  ]);
  const width = Math.max(lines.width, overlap.width, 3 * (pictureWidth + margin)) + 2 * margin;
  const parts = [place(lines, margin, margin), place(overlap, margin, 2 * margin + lines.height)];
  let y = 4 * margin + lines.height + overlap.height;
  for (let i = 0; i < pictures.length; i += 3) {
    const row = pictures.slice(i, i + 3);
    parts.push(...row.map((picture, column) => placePicture(picture, margin + column * (pictureWidth + margin), y)));
    y += Math.max(...row.map(heightOf)) + 2 * margin;
  }
  const size = `width="${width}" height="${y}" viewBox="0 0 ${width} ${y}"`;
  const background = `<rect width="${width}" height="${y}" fill="white"/>`;
  return `<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" ${size} font-family="sans-serif">${background}${parts.join("\n")}</svg>\n`;
}

/** @typedef {{ svg: string, width: number, height: number }} Svg */

/** @param {Svg} svg @param {number} x @param {number} y */
const place = ({ svg }, x, y) => svg.replace("<svg ", `<svg x="${x}" y="${y}" `);

/** @param {Picture} picture */
const heightOf = ({ width, height }) => (pictureWidth * height) / width;

/** @param {Picture} picture @param {number} x @param {number} y */
function placePicture(picture, x, y) {
  const title = picture.title.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  const href = `data:image/png;base64,${picture.png.toString("base64")}`;
  const size = `width="${pictureWidth}" height="${heightOf(picture)}"`;
  return `<text x="${x}" y="${y}" font-size="12">${title}</text><image x="${x}" y="${y + 8}" ${size} href="${href}"/>`;
}

/** @param {Spec} spec @returns {Promise<Svg>} */
async function chart(spec) {
  const [vega, vegaLite] = await Promise.all([import("vega"), import("vega-lite")]);
  const view = new vega.View(vega.parse(vegaLite.compile(spec).spec), { renderer: "none" });
  const svg = await view.toSVG();
  const [, width = 0, height = 0] = /<svg[^>]* width="([\d.]+)" height="([\d.]+)"/.exec(svg) ?? [];
  return { svg, width: Number(width), height: Number(height) };
}

/**
 * @param {{ values: object[] }} data
 * @param {readonly string[]} methods
 * @returns {Spec}
 */
function lineCharts(data, methods) {
  /** @type {(field: string, title: string, scale: "linear" | "symlog") => Panel} */
  const panelOf = (field, title, scale) => ({
    ...{ ...panel, mark: { type: "line", point: true } },
    encoding: {
      x: { field: "difficulty", type: "quantitative", title: "difficulty of the case", scale: { domain: [0, 1] } },
      y: { field, type: "quantitative", title, scale: { type: scale, domainMin: 0 } },
      color: { field: "method", type: "nominal", title: null, sort: [...methods], scale: { scheme: "tableau10" } },
    },
  });
  return {
    data,
    hconcat: [
      panelOf("success", "poses within the strict tolerance, %", "linear"),
      panelOf("rotationDeg", "median rotation error, °", "symlog"),
    ],
  };
}

/**
 * @param {{ values: object[] }} data
 * @param {readonly string[]} methods
 * @returns {Spec}
 */
function histograms(data, methods) {
  return {
    data,
    facet: { field: "method", type: "nominal", title: null, sort: [...methods] },
    columns: 5,
    spec: {
      ...{ width: 160, height: 110, mark: "bar" },
      encoding: {
        x: { field: "from", type: "quantitative", bin: { binned: true, step: 0.1 }, title: "IoU" },
        x2: { field: "to" },
        y: { field: "percent", type: "quantitative", title: "cases, %" },
      },
    },
  };
}
