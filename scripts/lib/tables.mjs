/**
 * Writes the lists of file formats, file names and depth kinds in documents and comments from the package's tables, and the
 * limits of the modules' sizes.
 */
import { filesBelow } from "./cache.mjs";
import { at } from "./paths.mjs";
import { holdUpToDate, rewrite } from "./rewrite.mjs";
import { wasmModules } from "./wasm.mjs";

const types = at("pkg-config", "src", "types", "inputs.ts");
const files = () => [
  ...[at("README.md"), types, at("pkg-config", "src", "formats.ts")],
  ...filesBelow([at("docs", "guides")]).filter((path) => path.endsWith(".md")),
];

/** The tables, from their source: the package need not be built. */
async function tables() {
  const { build } = await import("esbuild");
  const contents =
    'export * from "./case-names.js"; export * from "./input/formats.js"; export * from "./input/depth-kinds.js";';
  const stdin = { contents, resolveDir: at("pkg-config", "src") };
  const { outputFiles } = await build({ stdin, bundle: true, write: false, format: "esm" });
  return import(`data:text/javascript,${encodeURIComponent(outputFiles[0]?.text ?? "")}`);
}

/** The titles of the parts of a case folder. @type {Record<string, string>} */
const titles = {
  ...{ depth: "depth map", mask: "mask", mesh: "mesh", camera: "camera, optional", image: "photo, optional" },
  ...{ truth: "true pose, optional", initial: "first pose of an object of a scene, optional" },
  pose: "camera pose of a frame, optional",
};

/** A function that brings a text of a file up to date. */
async function update() {
  const { caseNames, depthKinds, either, fileFormats, formatsText } = await tables();
  const code = (/** @type {string[]} */ words) => either(words.map((word) => `\`${word}\``));
  const kinds = Object.entries(depthKinds);
  const lists = {
    "| `depthKind` | the values | estimated |\n|---|---|---|\n": kinds.map(([kind, { values, estimated }], i) => [
      ...[`\`${kind}\`${i === 0 ? " (default)" : ""}`, values, estimated],
    ]),
    "| part | names | extensions |\n|---|---|---|\n": Object.entries(caseNames).map(([part, { stems, extensions }]) => [
      ...[titles[part], code(stems), code(extensions.map((/** @type {string} */ ending) => `.${ending}`))],
    ]),
  };
  const comment = kinds.map(
    ([kind, { values }], i) => ` * - \`"${kind}"\`: ${values}${i < kinds.length - 1 ? ";" : "."}\n`,
  );
  return (/** @type {string} */ text) => {
    let now = text.replace(
      / \* What the values of a depth map are:\n \*\n( \* .*\n)*/,
      () => ` * What the values of a depth map are:\n *\n${comment.join("")}`,
    );
    // Such as "depth files (16-bit PNG, …)", which may go on in the next line.
    const words = Object.keys(fileFormats).join("|");
    const pattern = new RegExp(`\\b((${words}) files? \\()(\\w[^().;:]*)(?=[).;:])`, "gi");
    now = now.replace(pattern, (all, before, kind, list) => {
      const wanted = formatsText(kind.toLowerCase());
      return list.replace(/\s+(\* )?/g, " ") === wanted ? all : `${before}${wanted}`;
    });
    // Such as "The splats module, at most 62 kB".
    now = now.replace(/(?<=\bthe ([\w-]+)(?: readers| module)?(?:,| is) at most )[\d.]+(?= kB)/gi, (old, title) => {
      const name = title.toLowerCase().replace("file", "formats");
      const budget = wasmModules.find((one) => one.name === name)?.budget;
      return budget === undefined ? old : `${Math.ceil(budget / 1000)}`;
    });
    for (const [head, rows] of Object.entries(lists)) {
      const [before = "", after] = now.split(head);
      if (after === undefined) continue;
      const written = rows.map((cells) => `| ${cells.join(" | ")} |\n`).join("");
      now = `${before}${head}${written}${after.replace(/^(\|.*\n)*/, "")}`;
    }
    return now;
  };
}

export const writeTables = async () => rewrite(files(), await update());

/** @throws if a document or a comment disagrees with the tables */
export const checkTables = async () =>
  holdUpToDate(files(), await update(), "pkg-config/src/input/formats.ts, depth-kinds.ts or scripts/lib/wasm.mjs");
