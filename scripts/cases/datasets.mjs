/**
 * `npm run cases`: public data as case folders, for `SIM3ALIGN_CASES`, the record and the command line. The archives of a
 * dataset are fetched from its host, by the revision and the checksums of a lock file, and only what the selected cases need
 * is unpacked. Nothing is fetched before the licence has been shown and accepted.
 */
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { megabytes } from "../bench/table.mjs";
import { buildPackage } from "../lib/package.mjs";
import { at } from "../lib/paths.mjs";
import { step } from "../lib/step.mjs";
import { Archives } from "./archives.mjs";
import { makeCases, unpackBop } from "./bop.mjs";
import { download } from "./download.mjs";
import { failure } from "./failure.mjs";
import { lockedListing, writeLock } from "./listing.mjs";
import { selectionText } from "./selection.mjs";

/**
 * Datasets whose depth is PNG, and the split of each whose true poses are public, with the archive of its images.
 * @type {Record<string, { split: string, images: string }>}
 */
const datasets = {
  hb: { split: "val_primesense", images: "hb_val_primesense.zip" },
  hope: { split: "val_realsense", images: "hope_val_realsense.zip" },
  icbin: { split: "test", images: "icbin_test_bop19.zip" },
  lmo: { split: "test", images: "lmo_test_bop19.zip" },
  tless: { split: "test_primesense", images: "tless_test_primesense_bop19.zip" },
  tudl: { split: "test", images: "tudl_test_bop19.zip" },
  ycbv: { split: "test", images: "ycbv_test_bop19.zip" },
};

/**
 * @typedef {object} CasesOptions
 * @property {boolean} [accept] of the licence
 * @property {string} [from] an unpacked dataset
 * @property {string} [split]
 * @property {number} images
 * @property {number} visible
 * @property {boolean} [scenes]
 * @property {string} [out]
 * @property {string} host
 */

/**
 * Makes the folders, and says where they are; without `accept`, only says what would be fetched.
 * @param {string} name of the dataset
 * @param {CasesOptions} options
 * @param {() => Promise<void>} [build] builds the package, whose readers are used
 */
export async function cases(name, options, build = buildPackage) {
  const { from, split, out, scenes = false, accept, host, ...selection } = options;
  const known = datasets[name];
  const root = resolve(out ?? at("target", "cases"));
  if (from !== undefined) {
    await build();
    const source = { dataset: name, folder: resolve(from), selection: selectionText(selection) };
    return make(
      name,
      { folder: resolve(from), split: split ?? known?.split ?? "test", scenes, selection, source },
      root,
    );
  }
  if (known === undefined) {
    const remedy = "name one of these, or an unpacked dataset with --from";
    throw failure("UNKNOWN_DATASET", "dataset", name, Object.keys(datasets).join(", "), remedy);
  }
  if (split !== undefined && split !== known.split) {
    const remedy = "leave it out, or unpack that split yourself and name the folder with --from";
    throw failure("NOT_AVAILABLE", "--split", split, `${known.split}, which is the one that is fetched`, remedy);
  }
  const names = [`${name}_base.zip`, `${name}_models.zip`, known.images];
  const store = join(root, "archives", name);
  const lock = join(store, "lock.json");
  const listing = await lockedListing(lock, host, name, names);
  console.log(licenceText(listing));
  if (!accept) {
    console.log(`Nothing was fetched. If you accept the licence, add --accept.`);
    return;
  }
  for (const archive of names) await fetchArchive(listing, archive, store, lock);
  const folder = join(root, "bop", name);
  await build();
  await step("unpack what the cases need", async () => {
    const archives = await Archives.of(
      name,
      names.map((archive) => join(store, archive)),
    );
    await unpackBop(archives, folder, known.split, selection).finally(() => archives.close());
  });
  const { page, revision, licence } = listing;
  const source = { dataset: name, page, revision, licence, selection: selectionText(selection) };
  await make(name, { folder, split: known.split, scenes, selection, source }, root);
}

/** @param {import("./listing.mjs").Listing} listing */
function licenceText({ dataset, page, revision, licence, archives }) {
  const lines = Object.entries(archives).map(
    ([archive, { bytes, sha256 }]) =>
      `  ${archive}: ${bytes === null ? "size not stated" : `${megabytes(bytes)} MB`}, SHA-256 ${sha256 ?? "not stated by the host; that of the first download is kept"}`,
  );
  return [
    `${dataset}, ${page}, revision ${revision}`,
    `Licence: ${licence ?? "the host names none; see the page of the dataset"}. Whoever made the models may have another one: see the page.`,
    ...lines,
  ].join("\n");
}

/**
 * @param {import("./listing.mjs").Listing} listing
 * @param {string} name of the archive
 * @param {string} store
 * @param {string} lock
 */
async function fetchArchive(listing, name, store, lock) {
  const archive = listing.archives[name];
  if (archive === undefined) return;
  await step(name, async (say) => {
    const sha256 = await download(archive, join(store, name), progress(name, archive.bytes));
    say(archive.sha256 === null ? "its checksum is kept from now on" : "the checksum is right");
    archive.sha256 = sha256;
    writeLock(lock, listing);
  });
}

/** Prints how much is there at each tenth. @param {string} name @param {number | null} bytes */
function progress(name, bytes) {
  let next = 0.1;
  return (/** @type {number} */ there) => {
    if (bytes === null || there < next * bytes) return;
    console.log(`${name}: ${megabytes(there)} of ${megabytes(bytes)} MB`);
    next = Math.floor((10 * there) / bytes + 1) / 10;
  };
}

/**
 * @param {string} name
 * @param {Omit<import("./bop.mjs").Made, "out">} options
 * @param {string} root
 */
async function make(name, options, root) {
  const out = join(root, options.scenes ? "scenes" : "cases", name);
  const note = `${out}.json`;
  // A folder that something else has written is not replaced.
  if (existsSync(out) && !existsSync(note)) {
    const remedy = "name another folder with --out, or move what is there";
    throw failure("NO_CASES", out, "a folder that this command has not made", "a new folder", remedy);
  }
  mkdirSync(dirname(out), { recursive: true });
  writeFileSync(note, `${JSON.stringify(options.source, null, 2)}\n`);
  await step("folders", async (say) => {
    const { folders, objects } = await makeCases({ ...options, out });
    say(`${folders} folders with ${objects} objects`);
  });
  console.log(
    options.scenes
      ? `They are in ${out}: npx sim3align scene ${out}/SCENE`
      : `They are in ${out}: SIM3ALIGN_CASES=${out} npm run record, or npx sim3align align '${out}/*'`,
  );
}
