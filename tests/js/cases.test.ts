/** `npm run cases`: downloads from a local server, checksums, errors, and the case folders that it writes. */
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { tmpdir } from "node:os";
import { join, relative } from "node:path";
import { after, before, test } from "node:test";
import { images as scenes, writeBop } from "../support/bop-dataset.js";
import { run } from "../support/command-line.js";
import { scriptModule } from "../support/internals.js";
import { deflated, zip } from "../support/zip.js";

const { cases } = await scriptModule("cases/datasets.mjs");
const { download } = await scriptModule("cases/download.mjs");

const root = mkdtempSync(join(tmpdir(), "sim3align-cases-"));
after(() => rmSync(root, { recursive: true, force: true }));

const given = join(root, "given", "lmo");
/** The archives of the host, by name. */
const archives = new Map<string, Uint8Array>();
/** The sizes and checksums in the host's listing; a test may change them. */
const stated = new Map<string, { size?: number; sha256?: string }>();
/** The connection breaks, once, when so many bytes have reached a file. And the ranges that were asked for. */
let breaks: { bytes: number; file: string } | undefined;
const ranges: string[] = [];
let server: Server;
let host = "";

const sha256 = (bytes: Uint8Array) => createHash("sha256").update(bytes).digest("hex");
const quiet = { images: 1, visible: 0.3 };
const silent = async () => {};

before(async () => {
  writeBop(given);
  const paths = readdirSync(given, { recursive: true, encoding: "utf8" }).filter((path) =>
    statSync(join(given, path)).isFile(),
  );
  const archive = (name: string, prefix: string, belongs: (path: string) => boolean) => {
    const bytes = zip(
      paths
        .filter(belongs)
        .sort()
        .map((path) => deflated(prefix + path, readFileSync(join(given, path)))),
    );
    archives.set(name, bytes);
    stated.set(name, { size: bytes.length, sha256: sha256(bytes) });
  };
  archive("lmo_base.zip", "lmo/", (path) => path.startsWith("test_targets"));
  archive("lmo_models.zip", "", (path) => path.startsWith("models"));
  archive("lmo_test_bop19.zip", "", (path) => path.startsWith("test/"));
  server = createServer((request, response) => {
    const path = (request.url ?? "").split("?")[0] ?? "";
    if (path === "/api/datasets/bop-benchmark/lmo") {
      const siblings = [...stated].map(([rfilename, lfs]) => ({
        rfilename,
        ...(lfs.sha256 === undefined ? { size: lfs.size } : { lfs }),
      }));
      response.end(JSON.stringify({ sha: "5fd309a0", tags: ["license:cc-by-sa-4.0"], siblings }));
      return;
    }
    const bytes = archives.get(path.replace("/datasets/bop-benchmark/lmo/resolve/5fd309a0/", ""));
    if (bytes === undefined) {
      response.writeHead(404).end();
      return;
    }
    const { range } = request.headers;
    if (range !== undefined) ranges.push(range);
    const start = Number(/^bytes=(\d+)-$/.exec(range ?? "")?.[1] ?? 0);
    const length = { "content-length": bytes.length - start };
    response.writeHead(range === undefined ? 200 : 206, length);
    if (breaks === undefined) {
      response.end(bytes.subarray(start));
      return;
    }
    const { bytes: count, file } = breaks;
    breaks = undefined;
    response.write(bytes.subarray(start, start + count));
    const end = () => {
      if (existsSync(file) && statSync(file).size >= count) response.destroy();
      else setTimeout(end, 1);
    };
    end();
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  host = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
});
after(() => server.close());

/** The lines that a call prints. */
async function printed(call: () => Promise<void>): Promise<string> {
  const lines: string[] = [];
  const { log } = console;
  console.log = (...words: unknown[]) => lines.push(words.join(" "));
  await call().finally(() => {
    console.log = log;
  });
  return lines.join("\n");
}

/** The files below a folder, as paths in it. */
const filesIn = (folder: string) =>
  readdirSync(folder, { recursive: true, encoding: "utf8" })
    .filter((path) => statSync(join(folder, path)).isFile())
    .sort();

test("before anything is fetched, the licence, the sizes and the checksums are shown", async () => {
  const out = join(root, "shown");
  const text = await printed(() => cases("lmo", { ...quiet, out, host }, silent));
  assert.match(text, /Licence: cc-by-sa-4\.0/);
  for (const [name, { sha256: sum }] of stated) assert.ok(text.includes(name) && text.includes(sum ?? "?"), name);
  assert.match(text, /--accept/);
  assert.deepEqual(filesIn(out), ["archives/lmo/lock.json"]);
});

test("case folders of a fetched dataset are those of the unpacked one, hold no more, and align", async () => {
  const fetched = join(root, "fetched");
  await printed(() => cases("lmo", { ...quiet, out: fetched, host, accept: true }, silent));
  await printed(() => cases("lmo", { ...quiet, out: join(root, "local"), from: given }, silent));
  const [a, b] = [join(fetched, "cases", "lmo"), join(root, "local", "cases", "lmo")];
  assert.deepEqual(filesIn(a), filesIn(b));
  for (const path of filesIn(a).filter((path) => !path.endsWith("meta.json"))) {
    assert.ok(readFileSync(join(a, path)).equals(readFileSync(join(b, path))), path);
  }
  // Of scene 1, the later of two images: the third brick is too far behind the first one.
  const hidden = scenes[1]?.objects.length ?? 0;
  const chosen = readdirSync(a).sort();
  assert.ok(chosen.length > 0 && chosen.filter((name) => name.startsWith("000001-")).length < hidden, `${chosen}`);
  assert.ok(chosen.every((name) => !name.startsWith("000001-000000")));
  // What no case needs stays in the archives.
  const unpacked = filesIn(join(fetched, "bop", "lmo"));
  assert.ok(unpacked.includes("test/000001/depth/000007.png") && !unpacked.includes("test/000001/depth/000000.png"));
  assert.ok(!unpacked.some((path) => path.startsWith("models_eval/obj_")));
  const meta = JSON.parse(readFileSync(join(a, chosen[0] ?? "", "meta.json"), "utf8"));
  assert.equal(meta.licence, "cc-by-sa-4.0");
  assert.equal(meta.revision, "5fd309a0");
  // The true pose in metres: the error of an aligned case is small.
  const whole = "000002-000003-000001-1";
  const aligned = run("align", join(a, whole), "--json", join(root, "aligned.json"));
  assert.equal(aligned.status, 0, aligned.stderr);
  const result = JSON.parse(readFileSync(join(root, "aligned.json"), "utf8"))[whole];
  const truth = JSON.parse(readFileSync(join(a, whole, "gt.json"), "utf8"));
  assert.equal(truth.scale, 0.001);
  assert.ok(Math.abs(result.scale / truth.scale - 1) < 0.02, `scale ${result.scale}`);
  const off = Math.hypot(...truth.translation.map((x: number, i: number) => x - result.translation[i]));
  assert.ok(off < 0.01, `${off} m`);
});

test("scene folders are read as scenes", async () => {
  const out = join(root, "scenes");
  await printed(() => cases("lmo", { ...quiet, out, from: given, scenes: true }, silent));
  const folder = join(out, "scenes", "lmo", "000002-000003");
  assert.deepEqual(
    filesIn(folder).filter((path) => !path.includes("meta")),
    [
      "camera.json",
      "depth.png",
      ...["000001-1", "000003-0"].flatMap((name) =>
        ["gt.json", "mask.png", "mesh.ply"].map((f) => `objects/${name}/${f}`),
      ),
    ],
  );
  const { status, stderr } = run("scene", folder, "--json", join(root, "scene.json"));
  assert.equal(status, 0, stderr);
});

/** A new download of an archive of the host. */
const archiveOf = (name: string, of: { bytes?: number | null; sha256?: string | null } = {}) => ({
  address: `${host}/datasets/bop-benchmark/lmo/resolve/5fd309a0/${name}`,
  bytes: stated.get(name)?.size ?? null,
  sha256: stated.get(name)?.sha256 ?? null,
  ...of,
});

test("an interrupted download is continued, not begun anew", async () => {
  const path = join(root, "resumed", "lmo_models.zip");
  breaks = { bytes: 1000, file: `${path}.part` };
  await assert.rejects(download(archiveOf("lmo_models.zip"), path), { code: "INCOMPLETE", remedy: /again/ });
  assert.ok(!existsSync(path));
  const there = statSync(`${path}.part`).size;
  assert.equal(there, 1000);
  ranges.length = 0;
  await download(archiveOf("lmo_models.zip"), path);
  assert.deepEqual(ranges, [`bytes=${there}-`]);
  assert.deepEqual(readFileSync(path), Buffer.from(archives.get("lmo_models.zip") ?? []));
});

test("a wrong checksum is an error with a remedy, and leaves nothing that a later run would continue", async () => {
  const path = join(root, "wrong", "lmo_base.zip");
  const sum = stated.get("lmo_base.zip")?.sha256 ?? "";
  const wrong = archiveOf("lmo_base.zip", { sha256: sum.replace(/^./, (c) => (c === "0" ? "1" : "0")) });
  const error = { code: "CHECKSUM_MISMATCH", found: `SHA-256 ${sum}`, remedy: /run the command again/ };
  await assert.rejects(download(wrong, path), error);
  assert.deepEqual(readdirSync(join(root, "wrong")), []);
  // What is there is checked, too: a file of another kind does not stay.
  writeFileSync(path, "damaged");
  await assert.rejects(download(archiveOf("lmo_base.zip"), path), { code: "CHECKSUM_MISMATCH" });
  assert.ok(!existsSync(path));
});

test("where the host states no checksum, that of the first download is kept, and a change is refused", async () => {
  const out = join(root, "first-use");
  const name = "lmo_base.zip";
  const before = stated.get(name);
  const bytes = archives.get(name) ?? new Uint8Array();
  stated.set(name, { size: bytes.length });
  const lock = join(out, "archives", "lmo", "lock.json");
  try {
    await printed(() => cases("lmo", { ...quiet, out, host, accept: true }, silent));
    assert.equal(JSON.parse(readFileSync(lock, "utf8")).archives[name].sha256, sha256(bytes));
    rmSync(join(out, "archives", "lmo", name));
    const changed = Uint8Array.from(bytes);
    changed[changed.length >> 1] = (changed[changed.length >> 1] ?? 0) ^ 1;
    archives.set(name, changed);
    const again = () => printed(() => cases("lmo", { ...quiet, out, host, accept: true }, silent));
    await assert.rejects(again, { code: "CHECKSUM_MISMATCH" });
  } finally {
    archives.set(name, bytes);
    if (before !== undefined) stated.set(name, before);
  }
});

test("what cannot be is refused by name", async () => {
  const of = (name: string, more: object = {}) =>
    printed(() => cases(name, { ...quiet, out: join(root, "refused"), host, ...more }, silent));
  await assert.rejects(of("ycb"), { code: "UNKNOWN_DATASET", found: "ycb", expected: /ycbv/ });
  await assert.rejects(of("tless"), { code: "NOT_AVAILABLE", found: "status 404" });
  await assert.rejects(of("lmo", { host: "http://127.0.0.1:1" }), { code: "NOT_AVAILABLE", remedy: /--from/ });
  await assert.rejects(of("lmo", { split: "train" }), { code: "NOT_AVAILABLE", argument: "--split" });
  await assert.rejects(of("lmo", { from: given, visible: 1.1 }), { code: "NO_CASES", remedy: /--visible/ });
  await assert.rejects(download(archiveOf("lmo_none.zip"), join(root, "none.zip")), { code: "NOT_AVAILABLE" });
  // Somebody else's folder is left alone.
  const theirs = join(root, "theirs");
  await printed(() => cases("lmo", { ...quiet, out: theirs, from: given }, silent));
  rmSync(join(theirs, "cases", "lmo.json"));
  await assert.rejects(
    printed(() => cases("lmo", { ...quiet, out: theirs, from: given }, silent)),
    { code: "NO_CASES", argument: join(theirs, "cases", "lmo") },
  );
  assert.ok(relative(root, theirs) !== "" && filesIn(join(theirs, "cases", "lmo")).length > 0);
  const { Archives } = await scriptModule("cases/archives.mjs");
  const broken = join(root, "broken.zip");
  writeFileSync(broken, "no archive");
  await assert.rejects(Archives.of("lmo", [broken]), { code: "CORRUPT_FILE", argument: "broken.zip" });
});
