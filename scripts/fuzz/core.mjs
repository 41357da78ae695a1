/** The fuzzer of the Rust crates: `sim3align-lab fuzz`. */
import { run } from "../lib/run.mjs";
import { rustToolchain } from "../lib/setup.mjs";

/** @param {import("../fuzz.mjs").Budget} budget */
export async function fuzzCore({ minutes, seed }) {
  await rustToolchain();
  // The profile of the tests: optimised, and with checks of overflow.
  const program = ["run", "--quiet", "--package", "sim3align-lab", "--"];
  await run("cargo", [...program, "fuzz", "--minutes", `${minutes}`, "--seed", `${seed}`], {
    echo: true,
    remedy: "mend what the choices in lab/findings show, and keep them in lab/regressions",
  });
}
