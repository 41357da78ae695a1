/** Aligns the sample with the built package and shows what came of it. */
import { createAligner } from "../pkg/index.js";

const sample = new URL("samples/mug/", import.meta.url);

/**
 * A file of the sample.
 * @param {string} name
 */
async function fetchSample(name) {
  const response = await fetch(new URL(name, sample));
  if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}. Run "npm start" to make it.`);
  return response;
}

/** @param {string} name */
const bytes = async (name) => new Uint8Array(await (await fetchSample(name)).arrayBuffer());

/**
 * The page's element of that name.
 * @param {string} id
 */
function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The page has no element "${id}".`);
  return found;
}

/**
 * A value for people: numbers with four significant digits, null (not measurable) as a dash.
 * @param {unknown} value
 * @returns {string}
 */
function readable(value) {
  if (typeof value === "number") return String(Number(value.toPrecision(4)));
  if (Array.isArray(value) || ArrayBuffer.isView(value)) {
    return Array.from(/** @type {ArrayLike<unknown>} */ (value), readable).join(", ");
  }
  return value === null || value === undefined ? "–" : String(value);
}

/**
 * Fills a table with names and values.
 * @param {string} id
 * @param {object} values
 */
function show(id, values) {
  const rows = Object.entries(values).map(([name, value]) => {
    const row = document.createElement("tr");
    const heading = document.createElement("th");
    heading.scope = "row";
    heading.textContent = name;
    row.append(heading);
    row.insertCell().textContent = readable(value);
    return row;
  });
  element(id).replaceChildren(...rows);
}

/**
 * @param {string} text
 * @param {"working" | "done" | "failed"} state
 */
function say(text, state) {
  element("status").textContent = text;
  element("status").dataset.state = state;
}

try {
  const [aligner, depth, mask, mesh, camera] = await Promise.all([
    createAligner(),
    bytes("depth.npy"),
    bytes("mask.png"),
    bytes("mesh.glb"),
    fetchSample("camera.json").then((response) => response.json()),
  ]);
  say("Aligning …", "working");
  const alignment = await aligner.align({ depth, mask, mesh, camera });
  const { scale, rotation, translation, scaleRatio, metrics, timingsMs, warnings } = alignment;
  show("transform", {
    scale,
    "rotation (quaternion x, y, z, w)": rotation,
    "translation (m)": translation,
    "scale ratio": scaleRatio,
    confidence: alignment.confidence,
    alternatives: alignment.alternatives.length,
  });
  show("metrics", metrics ?? {});
  show("timings", timingsMs);
  element("warnings").replaceChildren(
    ...warnings.map((warning) => {
      const item = document.createElement("li");
      item.textContent = warning.message;
      return item;
    }),
  );
  element("result").hidden = false;
  say("Aligned.", "done");
} catch (error) {
  console.error(error);
  say(error instanceof Error ? error.message : String(error), "failed");
}
