/** The fuzzer of the Rust crates: `sim3align-lab fuzz`. */
import { runLab } from "../lib/lab.mjs";

/** @param {import("../fuzz.mjs").Budget} budget */
export async function fuzzCore({ minutes, seed }) {
  await runLab(["fuzz", "--minutes", `${minutes}`, "--seed", `${seed}`], {
    echo: true,
    remedy: "mend what the inputs show that it kept in lab/findings, and keep the inputs as regression cases",
  });
}
