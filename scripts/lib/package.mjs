/** The publishable package, written whole to pkg/. */

import { createHash } from "node:crypto";
import { copyFileSync, cpSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, normalize } from "node:path";
import { bundleGlue, bundleScripts, bundleTypes } from "./bundle.mjs";
import { cached, digest, once } from "./cache.mjs";
import { bundleElement } from "./element.mjs";
import { bundleInline } from "./inline.mjs";
import { NOTICE } from "./notices.mjs";
import { at, compiledDir, glueDir, packageDir, skinDir } from "./paths.mjs";
import { attempt, nodeProgram, run } from "./run.mjs";
import { wasmBindgenVersion } from "./setup.mjs";
import { step } from "./step.mjs";
import { binaryenVersion, buildWasm, sizes, wasmFile, wasmModules } from "./wasm.mjs";

/** Builds everything, and first installs what that needs. */
export const buildPackage = once(async () => {
  const version = packageVersion();
  await buildWasm();
  await step("package", async (say) => {
    const info = await buildInfo(version);
    // A package that is up to date stays as it is: others may be reading it.
    const outputs = [join(compiledDir, "package.json"), infoFile];
    const isNew = await cached(at("target", "package.stamp"), digest(sources(), [info]), outputs, () => write(info));
    say(`pkg/ holds sim3align ${version}${isNew ? "" : ", up to date"}`);
  });
});

/** The last file of the package that is written. */
const infoFile = join(packageDir, "build-info.json");

/** What the package is made of, beside the facts of its build. */
const sources = () => [
  ...[skinDir, at("www"), at("scripts", "lib"), at("package-lock.json"), at("tsconfig.base.json")],
  ...documents.map((name) => at(name)),
  ...guides.map((name) => at("docs", name)),
];

/** Writes the package. @param {string} info see {@link buildInfo} */
async function write(info) {
  for (const folder of [compiledDir, packageDir]) rmSync(folder, { recursive: true, force: true });
  const [node, tsc] = nodeProgram("typescript", "tsc");
  await run(node, [tsc, "--project", skinDir], { remedy: "correct what the compiler names, in pkg-config/src" });
  copyFiles();
  await bundleGlue();
  await bundleScripts();
  await bundleInline();
  await bundleElement();
  await bundleTypes();
  writeFileSync(infoFile, info);
}

/**
 * The version, which package.json and Cargo.toml have to agree on.
 * @returns {string}
 */
export function packageVersion() {
  const { version } = JSON.parse(readFileSync(join(skinDir, "package.json"), "utf8"));
  const crate = /^\[workspace\.package\][^[]*?^version = "([^"]+)"/ms.exec(readFileSync(at("Cargo.toml"), "utf8"))?.[1];
  if (version !== crate) {
    throw new Error(
      `pkg-config/package.json has version ${version}, Cargo.toml has ${crate}. Remedy: write the same in both.`,
    );
  }
  return version;
}

/** Files of the repository that the package carries. */
const documents = ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE", NOTICE];

/** Documents below docs/ that it carries, without their pictures. */
const guides = ["README.md", "guides", "benchmark.md", "how-it-works.md", "importing-results.md", "record.md"];

function copyFiles() {
  mkdirSync(packageDir);
  for (const folder of [compiledDir, packageDir])
    copyFileSync(join(skinDir, "package.json"), join(folder, "package.json"));
  for (const name of documents) {
    if (!existsSync(at(name))) throw new Error(`${name} is missing. Remedy: restore it; the package carries it.`);
    copyFileSync(at(name), join(packageDir, name));
  }
  for (const name of guides) cpSync(at("docs", name), join(packageDir, "docs", name), { recursive: true });
  linkToRepository();
  cpSync(join(skinDir, "sample"), join(packageDir, "sample"), { recursive: true });
  cpSync(glueDir, join(compiledDir, "wasm"), { recursive: true });
  // Its declarations are internal, and those of raw exports would be resolved for imports of the .wasm file.
  const isUsed = (/** @type {string} */ path) => !path.endsWith(".d.ts");
  cpSync(glueDir, join(packageDir, "wasm"), { recursive: true, filter: isUsed });
}

/** Makes links of the documents to files that the package does not carry lead to the repository. */
function linkToRepository() {
  const { repository } = JSON.parse(readFileSync(join(skinDir, "package.json"), "utf8"));
  const root = repository.url.replace(/^git\+|\.git$/g, "");
  const files = readdirSync(packageDir, { recursive: true, encoding: "utf8" });
  for (const file of files.filter((name) => name.endsWith(".md"))) {
    const folder = dirname(file);
    const text = readFileSync(join(packageDir, file), "utf8").replace(
      /(\]\(|(?:src|href)="|^\[[^\]]+\]: )([^)"\s#:]+)(?=[)"\s#])/gm,
      (whole, before, target) => {
        const path = normalize(join(folder, target));
        if (existsSync(join(packageDir, path)) || !existsSync(at(path))) return whole;
        return `${before}${root}/blob/HEAD/${path}${/\.(png|svg|webp)$/.test(path) ? "?raw=true" : ""}`;
      },
    );
    writeFileSync(join(packageDir, file), text);
  }
}

/**
 * What the package is made from and with, as JSON. It holds no date: the same sources give the same bytes.
 * @param {string} version
 */
async function buildInfo(version) {
  const commit = await attempt("git", ["rev-parse", "HEAD"]);
  const changes = await attempt("git", ["status", "--porcelain"]);
  const typescript = JSON.parse(readFileSync(at("node_modules", "typescript", "package.json"), "utf8")).version;
  const modules = wasmModules.map((module) => {
    const file = wasmFile(module);
    const sha256 = createHash("sha256").update(readFileSync(file)).digest("hex");
    const { raw, gzip } = sizes(file);
    return [module.name, { bytes: raw, gzippedBytes: gzip, sha256 }];
  });
  const info = {
    version,
    commit: commit.reason ? null : commit.output.trim(),
    uncommittedChanges: commit.reason ? null : changes.output.trim() !== "",
    toolchain: {
      rustc: (await run("rustc", ["--version"])).trim(),
      wasmBindgen: wasmBindgenVersion(),
      binaryen: binaryenVersion(),
      typescript,
    },
    modules: Object.fromEntries(modules),
  };
  return `${JSON.stringify(info, null, 2)}\n`;
}
