/** The page's reader of zip archives: what it refuses before it inflates, and what while it does. */
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { zipSync } from "fflate";
import { Sim3AlignError } from "sim3align";
import { installDir, repository } from "../support/environment.js";
import { deflated, type ZipEntry, zeros, zip } from "../support/zip.js";

interface NamedFile {
  path: string;
  size?: number;
  bytes(): Promise<Uint8Array>;
}
let extractArchives: (files: readonly NamedFile[]) => Promise<NamedFile[]>;
let limits: { MAX_FILES: number; MAX_BYTES: number; MAX_RATIO: number; RATIO_FROM_BYTES: number };

before(async () => {
  const folder = join(installDir, "archives");
  mkdirSync(folder, { recursive: true });
  const sources = ["archives", "allowance"].map((name) => join(repository, "www", "src", "load", `${name}.ts`));
  // The installed package stays outside, so that its error is the one that this test imports.
  const external = ["sim3align"];
  await build({
    entryPoints: sources,
    bundle: true,
    format: "esm",
    outdir: folder,
    outExtension: { ".js": ".mjs" },
    external,
  });
  ({ extractArchives } = await import(pathToFileURL(join(folder, "archives.mjs")).href));
  limits = await import(pathToFileURL(join(folder, "allowance.mjs")).href);
});

const file = (path: string, content: Uint8Array): NamedFile => ({ path, bytes: async () => content });

const extract = (entries: readonly ZipEntry[], count?: number) =>
  extractArchives([file("case.zip", zip(entries, count))]);

/** The error that a promise fails with, which has all its parts. */
async function refused(promise: Promise<unknown>, code: string, found: RegExp): Promise<Sim3AlignError> {
  const error = await promise.then(
    () => assert.fail("it is not refused"),
    (cause: unknown) => cause,
  );
  assert.ok(error instanceof Sim3AlignError, String(error));
  assert.equal(error.code, code, error.message);
  assert.match(error.found, found);
  assert.ok(error.expected.length > 0 && error.remedy.length > 0);
  return error;
}

/** Not deflate: inflating it fails by itself. */
const garbage = Uint8Array.of(0xff, 0xff, 0xff);

test("archives are replaced by their files, whatever wrote them", async () => {
  const noise = Uint8Array.from({ length: 300_000 }, (_, i) => (i * i) >> 3);
  const content = { "mug/depth.npy": noise, "mug/empty.txt": new Uint8Array(), "mug/ü.json": Uint8Array.of(1, 2) };
  const others = { "__MACOSX/mug/._depth.npy": garbage, "mug/.DS_Store": garbage };
  for (const level of [0, 1, 9] as const) {
    const packed = zipSync({ ...content, ...others, "mug/folder/": new Uint8Array() }, { level });
    const files = await extractArchives([file("a.zip", packed), file("mesh.obj", noise)]);
    assert.deepEqual(
      files.map(({ path }) => path),
      [...Object.keys(content), "mesh.obj"],
    );
    for (const [i, expected] of Object.values(content).entries()) assert.deepEqual(await files[i]?.bytes(), expected);
  }
});

test("an archive within a larger array is read from its own bytes", async () => {
  const packed = zip([deflated("a.txt", Uint8Array.of(1, 2, 3))]);
  const larger = new Uint8Array(packed.length + 200);
  larger.set(packed, 100);
  const [a] = await extractArchives([file("case.zip", larger.subarray(100, 100 + packed.length))]);
  assert.deepEqual(await a?.bytes(), Uint8Array.of(1, 2, 3));
});

test("depth of 12 megapixels of one value passes, although it inflates a thousandfold", async () => {
  const bytes = 12 << 22;
  const entry = zeros("depth.npy", bytes);
  assert.ok(bytes > 900 * entry.packed.length && bytes < limits.RATIO_FROM_BYTES);
  const [depth] = await extract([entry]);
  assert.equal((await depth?.bytes())?.length, bytes);
});

test("too many files are refused before anything is inflated", async () => {
  const many = (count: number) =>
    Array.from({ length: count }, (_, i): ZipEntry => ({ path: `${i}.txt`, packed: garbage, inflated: 9 }));
  await refused(extract(many(limits.MAX_FILES + 1)), "FILE_TOO_LARGE", /^10001 files .*case\.zip$/);
  // Neither does their number in several archives pass, nor one that only the end of the archive declares.
  const halves = [0, 1].map((i) => file(`${i}.zip`, zip(many(limits.MAX_FILES / 2 + i))));
  await refused(extractArchives(halves), "FILE_TOO_LARGE", /^10001 files/);
  await refused(extract([], 0xffff), "FILE_TOO_LARGE", /^65535 files/);
});

test("too large a total is refused before anything is inflated", async () => {
  const entry = (inflated: number): ZipEntry => ({ path: "a.bin", packed: garbage, inflated });
  await refused(extract([entry(3e9)]), "FILE_TOO_LARGE", /^3\.0 GB of files with case\.zip$/);
  const halves = ["a", "b"].map((name) => file(`${name}.zip`, zip([{ ...entry(6e8), packed: new Uint8Array(1e7) }])));
  await refused(extractArchives(halves), "FILE_TOO_LARGE", /^1\.2 GB of files with [ab]\.zip$/);
  const onDisk = { ...file("case.zip", garbage), size: 5e9, bytes: () => assert.fail("it is read") };
  await refused(extractArchives([onDisk]), "FILE_TOO_LARGE", /^5\.0 GB of files with case\.zip$/);
});

test("too high a ratio is refused above an absolute size, and not below", async () => {
  const { RATIO_FROM_BYTES, MAX_RATIO } = limits;
  const entry = (inflated: number): ZipEntry => ({ path: "a.bin", packed: new Uint8Array(1e6), inflated });
  const error = await refused(
    extract([entry(RATIO_FROM_BYTES + 1)]),
    "FILE_TOO_LARGE",
    /1\.00 MB that inflate to 250 MB/,
  );
  assert.match(error.expected, new RegExp(`${MAX_RATIO} times`));
  // What is not refused by its directory is inflated, which fails.
  await refused(extract([entry(RATIO_FROM_BYTES)]), "CORRUPT_FILE", /a\.bin/);
});

test("headers that declare another size than there is are found while inflating", async () => {
  const bomb = { ...zeros("a.bin", 1 << 30), inflated: 1000 };
  await refused(extract([bomb]), "CORRUPT_FILE", /^a\.bin in case\.zip.* more than the 1000 bytes/);
  await refused(extract([{ ...deflated("a.bin", garbage), inflated: 7 }]), "CORRUPT_FILE", /holds 3 of the 7 bytes/);
  const stored: ZipEntry = { path: "a.bin", packed: garbage, inflated: 2, method: 0 };
  await refused(extract([stored]), "CORRUPT_FILE", /more than the 2 bytes/);
});

test("an archive in an archive, encryption and other methods are refused by name", async () => {
  const inner = zip([zeros("zeros.bin", 1 << 22)]);
  await refused(extract([deflated("a/inner.ZIP", inner)]), "UNSUPPORTED_FORMAT", /a\/inner\.ZIP in case\.zip/);
  const entry = deflated("a.bin", garbage);
  await refused(extract([{ ...entry, flags: 1 }]), "UNSUPPORTED_FORMAT", /a\.bin in case\.zip, encrypted/);
  await refused(extract([{ ...entry, method: 14 }]), "UNSUPPORTED_FORMAT", /the method 14/);
});

test("an archive that is cut off anywhere is corrupt", async () => {
  const whole = zip([deflated("a.bin", new Uint8Array(5000)), deflated("b.bin", garbage)]);
  for (let length = 0; length < whole.length; length++) {
    const archive = file("case.zip", whole.subarray(0, length));
    await refused(extractArchives([archive]), "CORRUPT_FILE", /case\.zip/);
    // Its directory still there, but what it refers to cut out of the middle.
    const short = Buffer.concat([whole.subarray(0, length), whole.subarray(length + 1)]);
    await extractArchives([file("case.zip", short)]).catch((cause) =>
      assert.ok(cause instanceof Sim3AlignError, `${cause}`),
    );
  }
  await refused(extract([deflated("a.bin", garbage)], 2), "CORRUPT_FILE", /ends after 1 of 2 entries/);
});
