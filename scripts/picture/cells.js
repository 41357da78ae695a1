// Images of a trace on the cells of a grid.

/** The classes of cells, with their colours and words. */
const CLASSES = {
  agrees: { colour: [22, 130, 120], text: "mask: depths agree" },
  differs: { colour: [250, 205, 70], text: "mask: depths differ" },
  unread: { colour: [165, 212, 208], text: "mask: no reading" },
  missing: { colour: [110, 120, 135], text: "mask: not covered" },
  free: { colour: [215, 60, 50], text: "outside: free space" },
  hidden: { colour: [150, 90, 190], text: "outside: hidden" },
  unknown: { colour: [200, 180, 165], text: "outside: no reading" },
};
const EMPTY = [246, 246, 246];

const mixed = (a, b, share) => a.map((x, k) => Math.round(x + (b[k] - x) * share));

/** The classes for a legend. */
export const classes = Object.values(CLASSES).map(({ colour, text }) => ({ colour: `rgb(${colour})`, text }));

/** The colour of a cell that a mesh at the depth `z`, 0 for none, has to explain: as `Scoring::score` counts it. */
function colourOf(grid, z, i) {
  const [isMask, seen, scene] = [grid.mask[i], grid.depth[i], grid.scene[i]];
  if (z === 0) return isMask ? CLASSES.missing.colour : EMPTY;
  if (isMask) {
    if (seen === 0) return CLASSES.unread.colour;
    const error = Math.abs(z - seen) / grid.depthM;
    return mixed(CLASSES.agrees.colour, CLASSES.differs.colour, Math.min(1, (2 * error) / (1 + error)));
  }
  if (scene <= 0) return CLASSES.unknown.colour;
  return scene < z - grid.occluderM ? CLASSES.hidden.colour : CLASSES.free.colour;
}

/** Cells around the box of the mask that are shown, relative to its longer side. */
const MARGIN = 0.22;

/** A canvas of the part of a grid around the mask, each cell in one colour, so many pixels high. */
function canvasOf({ width, height, mask }, high, colour) {
  const inside = [...mask.keys()].filter((i) => mask[i]);
  const [us, vs] = [inside.map((i) => i % width), inside.map((i) => Math.floor(i / width))];
  const box = [us, vs].map((list) => [list.reduce((a, b) => Math.min(a, b)), list.reduce((a, b) => Math.max(a, b))]);
  const margin = Math.ceil(MARGIN * Math.max(...box.map(([low, high]) => high - low)));
  const [left, top] = box.map(([low]) => Math.max(0, low - margin));
  const [right, bottom] = [width, height].map((most, k) => Math.min(most, box[k][1] + margin + 1));
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [right - left, bottom - top];
  canvas.style.height = `${high}px`;
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(width, height);
  for (let i = 0; i < width * height; i++) pixels.data.set([...colour(i), 255], 4 * i);
  context.putImageData(pixels, -left, -top);
  return canvas;
}

/** What an image of a pose explains. */
export const explained = (grid, z, high) => canvasOf(grid, high, (i) => colourOf(grid, z[i], i));

/** What was observed: the depth map in grey, the mask in blue. */
export function observed(grid, high) {
  const depths = grid.scene.filter((z) => z > 0.01).sort((a, b) => a - b);
  const [near, far] = [depths[0], depths[Math.floor(0.98 * depths.length)]];
  return canvasOf(grid, high, (i) => {
    const z = grid.scene[i];
    const bright = z > 0.01 ? 70 + 170 * Math.min(1, Math.max(0, (far - z) / (far - near))) : 16;
    return (grid.mask[i] ? [0.25, 0.75, 1] : [0.8, 0.83, 0.9]).map((c) => Math.round(c * bright));
  });
}

/** A figure of an element with a caption. */
export function figure(element, caption) {
  const figure = document.createElement("figure");
  const text = document.createElement("figcaption");
  text.textContent = caption;
  figure.append(element, text);
  return figure;
}

/** Colours with their words. */
export function legend(entries) {
  const list = document.createElement("div");
  list.className = "legend";
  for (const { colour, text } of entries) {
    const line = document.createElement("span");
    const box = document.createElement("i");
    box.style.background = colour;
    line.append(box, text);
    list.append(line);
  }
  return list;
}
