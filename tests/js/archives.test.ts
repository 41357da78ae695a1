/** The page's reader of zip archives: what it refuses before it inflates, and what while it does. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { zipSync } from "fflate";
import { Sim3AlignError } from "sim3align";
import { pageModule } from "../support/page-module.js";
import { deflated, type ZipEntry, zeros, zip } from "../support/zip.js";

interface NamedFile {
  path: string;
  size?: number;
  bytes(): Promise<Uint8Array>;
}
const { extractArchives } = await pageModule<{ extractArchives(files: readonly NamedFile[]): Promise<NamedFile[]> }>(
  "input/archives",
);
type Limits = { MAX_FILES: number; MAX_RATIO: number; RATIO_FROM_BYTES: number };
const { MAX_FILES, MAX_RATIO, RATIO_FROM_BYTES } = await pageModule<Limits>("input/allowance");

const file = (path: string, content: Uint8Array): NamedFile => ({ path, bytes: async () => content });
const extract = (entries: readonly ZipEntry[], count?: number) =>
  extractArchives([file("case.zip", zip(entries, count))]);

/** Not deflate: inflating it fails by itself. */
const garbage = Uint8Array.of(0xff, 0xff, 0xff);

test("archives are replaced by their files, whatever wrote them", async () => {
  const noise = Uint8Array.from({ length: 300_000 }, (_, i) => (i * i) >> 3);
  const content = { "mug/depth.npy": noise, "mug/empty.txt": new Uint8Array(), "mug/ü.json": Uint8Array.of(1, 2) };
  const others = { "__MACOSX/mug/._depth.npy": garbage, "mug/.DS_Store": garbage, "mug/folder/": new Uint8Array() };
  for (const level of [0, 1, 9] as const) {
    const packed = zipSync({ ...content, ...others }, { level });
    // Within a larger array, as a part of it.
    const larger = new Uint8Array(packed.length + 200);
    larger.set(packed, 100);
    const files = await extractArchives([file("a.zip", larger.subarray(100, -100)), file("mesh.obj", noise)]);
    const paths = files.map(({ path }) => path);
    assert.deepEqual(paths, [...Object.keys(content), "mesh.obj"]);
    for (const [i, expected] of Object.values(content).entries()) assert.deepEqual(await files[i]?.bytes(), expected);
  }
  // Depth of 12 megapixels of one value inflates a thousandfold.
  const entry = zeros("depth.npy", 12 << 22);
  assert.ok(12 << 22 > 900 * entry.packed.length && 12 << 22 < RATIO_FROM_BYTES);
  assert.equal((await (await extract([entry]))[0]?.bytes())?.length, 12 << 22);
});

const many = (count: number) =>
  Array.from({ length: count }, (_, i): ZipEntry => ({ path: `${i}.txt`, packed: garbage, inflated: 9 }));
const claiming = (inflated: number, packed = garbage): ZipEntry => ({ path: "a.bin", packed, inflated });
const halves = (entries: (k: number) => readonly ZipEntry[]) =>
  extractArchives([0, 1].map((k) => file(`${k}.zip`, zip(entries(k)))));
const onDisk = { ...file("case.zip", garbage), size: 5e9, bytes: () => assert.fail("it is read") };
const a = deflated("a.bin", garbage);
const ratio = new Uint8Array(1e6);

/** The fault, and the call. What is refused by its directory is not inflated: the garbage would be corrupt. */
const refused: Record<string, [fault: string, found: RegExp, call: () => Promise<unknown>]> = {
  "too many files": ["FILE_TOO_LARGE", /^10001 files .*case\.zip$/, () => extract(many(MAX_FILES + 1))],
  "too many in two archives": ["FILE_TOO_LARGE", /^10001 files/, () => halves((k) => many(MAX_FILES / 2 + k))],
  "too many by its end": ["FILE_TOO_LARGE", /^65535 files/, () => extract([], 0xffff)],
  "too large a file": ["FILE_TOO_LARGE", /^3\.0 GB of files with case\.zip$/, () => extract([claiming(3e9)])],
  "too large together": ["FILE_TOO_LARGE", /^1\.2 GB/, () => halves(() => [claiming(6e8, new Uint8Array(1e7))])],
  "too large on disk": ["FILE_TOO_LARGE", /^5\.0 GB of files with case\.zip$/, () => extractArchives([onDisk])],
  "too high a ratio": [
    "FILE_TOO_LARGE",
    /1\.00 MB that.* 250 MB/,
    () => extract([claiming(RATIO_FROM_BYTES + 1, ratio)]),
  ],
  "the same ratio of less": ["CORRUPT_FILE", /a\.bin/, () => extract([claiming(RATIO_FROM_BYTES, ratio)])],
  "a bomb that claims less": [
    "CORRUPT_FILE",
    /^a\.bin in case\.zip.* more than the 1000 bytes/,
    () => extract([{ ...zeros("a.bin", 1 << 30), inflated: 1000 }]),
  ],
  "less than it claims": ["CORRUPT_FILE", /holds 3 of the 7 bytes/, () => extract([{ ...a, inflated: 7 }])],
  "stored, more than it claims": ["CORRUPT_FILE", /more than the 2/, () => extract([{ ...claiming(2), method: 0 }])],
  "an archive in an archive": [
    "UNSUPPORTED_FORMAT",
    /a\/inner\.ZIP in case\.zip/,
    () => extract([deflated("a/inner.ZIP", zip([a]))]),
  ],
  encryption: ["UNSUPPORTED_FORMAT", /a\.bin in case\.zip, encrypted/, () => extract([{ ...a, flags: 1 }])],
  "another method": ["UNSUPPORTED_FORMAT", /the method 14/, () => extract([{ ...a, method: 14 }])],
  "fewer entries than it claims": ["CORRUPT_FILE", /ends after 1 of 2 entries/, () => extract([a], 2)],
};

async function assertRefused(call: () => Promise<unknown>, code: string, found: RegExp, name = ""): Promise<void> {
  const error = await call().then(
    () => assert.fail(`${name}: it is not refused`),
    (cause: unknown) => cause,
  );
  assert.ok(error instanceof Sim3AlignError, `${name}: ${error}`);
  assert.equal(error.code, code, `${name}: ${error.message}`);
  assert.match(error.found, found, name);
  assert.ok(error.expected.length > 0 && error.remedy.length > 0, name);
}

test("what is too large, false or of another kind is refused by name", async () => {
  for (const [name, [code, found, call]] of Object.entries(refused)) await assertRefused(call, code, found, name);
  const high = extract([claiming(RATIO_FROM_BYTES + 1, ratio)]);
  await assert.rejects(high, (error: Sim3AlignError) => error.expected.includes(`${MAX_RATIO} times`));
});

test("an archive that is cut off anywhere is corrupt", async () => {
  const whole = zip([deflated("a.bin", new Uint8Array(5000)), deflated("b.bin", garbage)]);
  for (let length = 0; length < whole.length; length++) {
    const cut = () => extractArchives([file("case.zip", whole.subarray(0, length))]);
    await assertRefused(cut, "CORRUPT_FILE", /case\.zip/, `${length} bytes`);
    // Its directory still there, but what it refers to cut out of the middle.
    const short = Buffer.concat([whole.subarray(0, length), whole.subarray(length + 1)]);
    await extractArchives([file("case.zip", short)]).catch((cause) =>
      assert.ok(cause instanceof Sim3AlignError, `${cause}`),
    );
  }
});
