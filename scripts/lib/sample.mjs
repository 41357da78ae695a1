/** The sample that tests, examples and measurements use: a copy of one of the page's, with its depth as .npy. */
import { cpSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { cached, digest, once } from "./cache.mjs";
import { buildPackage } from "./package.mjs";
import { at, packageDir, sampleDir } from "./paths.mjs";

/** Writes the copies. */
export const copySample = once(async () => {
  await buildPackage();
  const copies = [sampleDir, at("examples", "sample", "mug")];
  const source = at("www", "samples", "mug");
  const outputs = copies.map((folder) => join(folder, "depth.npy"));
  await cached(
    at("target", "samples", "copied-from"),
    digest([source, at("scripts", "lib", "sample.mjs")]),
    outputs,
    async () => {
      const { readDepth } = await import(pathToFileURL(join(packageDir, "formats.js")).href);
      const { depthScale, ...camera } = JSON.parse(readFileSync(join(source, "camera.json"), "utf8"));
      const { data, width, height } = await readDepth(readFileSync(join(source, "depth.png")), { depthScale });
      for (const folder of copies) {
        rmSync(folder, { recursive: true, force: true });
        cpSync(source, folder, { recursive: true, filter: (path) => !path.endsWith("depth.png") });
        writeFileSync(join(folder, "depth.npy"), npy(data, [height, width]));
        writeFileSync(join(folder, "camera.json"), `${JSON.stringify(camera, null, 2)}\n`);
      }
    },
  );
});

/**
 * A .npy file.
 * @param {Float32Array} values
 * @param {readonly number[]} shape
 */
function npy(values, shape) {
  const header = `{'descr': '<f4', 'fortran_order': False, 'shape': (${shape.join(", ")}), }`;
  const length = Math.ceil((header.length + 11) / 64) * 64 - 10;
  const start = Buffer.alloc(10 + length, " ");
  start.write("\x93NUMPY\x01\x00", "latin1");
  start.writeUInt16LE(length, 8);
  start.write(header, 10);
  start.write("\n", 9 + length);
  return Buffer.concat([start, Buffer.from(values.buffer)]);
}
