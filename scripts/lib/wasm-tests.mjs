/**
 * Runs the tests of a WebAssembly program in Node, as cargo's runner: `node wasm-tests.mjs FILE [NAME]`, with a part of the names of
 * the tests that run.
 */
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { bindgenProgram } from "./setup.mjs";

const [file = "", filter = ""] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "sim3align-tests-"));
execFileSync(bindgenProgram, ["tests", file, folder, "tests"]);

// wasm-bindgen-test prints what a test has printed only where it fails.
const shared = /** @type {any} */ (globalThis);
const { error, log } = console;
Object.assign(shared, { __wbgtest_og_console_log: log, __wbgtest_og_console_error: error });
shared.__wbg_test_invoke = (/** @type {() => unknown} */ test) => test();
const wasm = createRequire(import.meta.url)(join(folder, "tests.js"));
rmSync(folder, { recursive: true });
for (const method of /** @type {const} */ (["debug", "log", "info", "warn", "error"]))
  console[method] = (...values) => wasm[`__wbgtest_console_${method}`](values);

const exported = WebAssembly.Module.exports(new WebAssembly.Module(readFileSync(file)));
const tests = exported.map(({ name }) => name).filter((name) => name.startsWith("__wbgt_"));
const chosen = tests.filter((name) => name.slice(name.indexOf("::")).includes(filter));
const context = new wasm.WasmBindgenTestContext(false);
context.filtered_count(tests.length - chosen.length);
const isRight = await context.run(chosen.map((name) => wasm.__wasm[name]));
process.exit(isRight ? 0 : 1);
