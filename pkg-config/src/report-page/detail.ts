/** The details of a case: pictures with layers, alternatives, numbers, and the view in 3D. */
import { byId, element } from "./dom.js";
import { fixed, type ReportDetails, type ReportHost, type ReportRow, significant } from "./row.js";
import { SpaceView } from "./space-view.js";

/** The layers over the picture, from below, and whether each is shown at first. */
const layers = [
  ["mask", "Mask", false],
  ["mesh", "Mesh", false],
  ["residual", "Depth difference", false],
  ["outlines", "Outlines", true],
] as const;

const isShown = new Map<string, boolean>(layers.map(([name, , isOn]) => [name, isOn]));

/** Loads the details of a case once: a script, because pages from disk may not fetch. */
function loaded(host: ReportHost, folder: string): Promise<ReportDetails> {
  const known = host.details[folder];
  if (known !== undefined) return Promise.resolve(known);
  return new Promise((resolve, reject) => {
    const script = element("script", { src: `cases/${folder}/details.js` });
    script.addEventListener("load", () => {
      script.remove();
      const details = host.details[folder];
      if (details === undefined) reject(new Error("The file of this case is damaged."));
      else resolve(details);
    });
    script.addEventListener("error", () => reject(new Error("The file of this case is missing.")));
    document.head.append(script);
  });
}

/** A part of the panel under its title. */
const section = (title: string, ...children: Node[]) =>
  element("section", { "aria-label": title }, element("h3", {}, title), ...children);

/** The panel of details. */
export class Detail {
  readonly #panel = byId("detail");
  #space: SpaceView | undefined;
  #row: ReportRow | undefined;

  constructor(private readonly host: ReportHost) {}

  /** Shows a case. */
  show(row: ReportRow): void {
    this.#row = row;
    this.#space?.dispose();
    this.#space = undefined;
    const body = element("div");
    this.#panel.replaceChildren(element("h2", {}, row.name), body);
    if (row.error !== undefined)
      body.append(element("p", { class: "problem" }, `${row.error.code}: ${row.error.message}`));
    if (row.warnings.length > 0) {
      const items = row.warnings.map(({ code, message }) =>
        element("li", {}, element("strong", {}, code), ` ${message}`),
      );
      body.append(element("ul", { class: "warnings", "aria-label": "Warnings" }, ...items));
    }
    const { folder } = row;
    if (folder === undefined) {
      if (row.error === undefined) body.append(element("p", {}, "This case has no pictures."));
      return;
    }
    body.prepend(this.#picture(folder));
    loaded(this.host, folder).then(
      (details) => {
        // Another case may have been selected since.
        if (this.#row === row) this.#fill(body, row, folder, details);
      },
      (error: Error) => {
        if (this.#row === row) body.append(element("p", { class: "problem" }, error.message));
      },
    );
  }

  #picture(folder: string): HTMLElement {
    const image = (name: string, alt: string) =>
      element("img", {
        ...{ src: `cases/${folder}/${name}.png`, alt, width: 440, height: 330 },
        ...{ "data-layer": name, decoding: "async" },
      });
    const stack = element("div", { class: "stack" }, image("ground", "What was seen, around the object"));
    const boxes = layers.map(([name, label]) => {
      const drawn = image(name, `${label} over the picture`);
      drawn.hidden = !isShown.get(name);
      stack.append(drawn);
      const box = element("input", { type: "checkbox", id: `layer-${name}` });
      box.checked = !drawn.hidden;
      box.addEventListener("change", () => {
        drawn.hidden = !box.checked;
        isShown.set(name, box.checked);
      });
      return element("label", {}, box, ` ${label}`);
    });
    return element(
      "section",
      { "aria-label": "Picture" },
      stack,
      element("div", { class: "layers", role: "group", "aria-label": "Layers" }, ...boxes),
    );
  }

  #fill(
    body: HTMLElement,
    row: ReportRow,
    folder: string,
    { limitM, isPhoto, alternatives, matrix, space }: ReportDetails,
  ): void {
    // The unit of lengths that are not metric is unknown.
    const length = (metres: number | null | undefined, digits: number) =>
      row.isMetric ? `${fixed(metres && 1000 * metres, digits)} mm` : `${fixed(metres, digits + 3)} units`;
    const legend = element(
      "p",
      { class: "legend" },
      `Over the ${isPhoto ? "photo" : "depth map"}: `,
      element("span", { class: "key mesh" }, "mesh"),
      element("span", { class: "key mask" }, "mask"),
      element("span", { class: "key near" }, `mesh ${length(limitM, 0)} nearer`),
      element("span", { class: "key far" }, `${length(limitM, 0)} farther`),
    );
    const canvas = element("canvas", {
      width: 440,
      height: 300,
      tabindex: 0,
      role: "img",
      "aria-label":
        "The mesh and the observed points in 3D. Drag or use the arrow keys to turn, the wheel or plus and minus to zoom.",
    });
    body.querySelector(".layers")?.after(legend);
    this.#space = SpaceView.of(canvas, space);
    if (this.#space !== undefined) body.append(section("3D", canvas));
    if (alternatives.length > 0) {
      const figures = alternatives.map(({ file, turnDeg, score }) =>
        element(
          "figure",
          {},
          element("img", {
            ...{ src: `cases/${folder}/${file}`, alt: `The mesh turned by ${turnDeg.toFixed(0)} degrees` },
            ...{ width: 160, height: 120, loading: "lazy" },
          }),
          element("figcaption", {}, `turned ${turnDeg.toFixed(0)}°, score ${score.toFixed(3)}`),
        ),
      );
      body.append(section("Alternatives", element("div", { class: "alternatives" }, ...figures)));
    }
    const numbers: [string, string][] = [
      ["Confidence", fixed(row.confidence, 3)],
      ["Scale", `${significant(row.scale, 6)} ${row.isMetric ? "m" : "units"} per mesh unit`],
      ["Silhouette IoU", fixed(row.iou, 4)],
      ["Boundary F", fixed(row.boundaryF, 4)],
      ["Depth difference", length(row.depthMaeM, 2)],
      ["Chamfer distance", length(row.chamferM, 2)],
    ];
    const entries = numbers.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]);
    const rows = [0, 1, 2, 3].map((i) =>
      [0, 1, 2, 3].map((j) => (matrix[4 * j + i] ?? 0).toFixed(6).padStart(11)).join(" "),
    );
    const text = element("pre", { tabindex: 0, "aria-label": "Camera from mesh, rows" }, rows.join("\n"));
    body.append(section("Numbers", element("dl", {}, ...entries), text));
  }
}
