/** One bar for all of a benchmark's work, with the time that is left. */
import { duration } from "../lib/step.mjs";

/** How often a log that is no terminal gets a line, in milliseconds. */
const logEveryMs = 30_000;

/** Work is counted in seconds as they were expected, so that the time left is about right with work of all kinds. */
export class Progress {
  #bar;
  #done = 0;
  #started = performance.now();
  #doneAtStart = 0;
  #total;

  /**
   * @param {typeof import("cli-progress")} library
   * @param {number} total
   */
  constructor({ SingleBar, Presets }, total) {
    this.#total = total;
    const format = "{bar} {percentage}% | {left} left | {task}";
    const options = { format, noTTYOutput: true, notTTYSchedule: logEveryMs, hideCursor: true, linewrap: false };
    this.#bar = new SingleBar(options, Presets.shades_classic);
    this.#bar.start(total, 0, { left: "?", task: "" });
  }

  /** Counts what an earlier run has done; it says nothing of the speed. @param {number} work */
  skip(work) {
    this.#doneAtStart += work;
    this.advance(work, "");
  }

  /** @param {number} work @param {string} task what was done */
  advance(work, task) {
    this.#done += work;
    const speed = (this.#done - this.#doneAtStart) / (performance.now() - this.#started);
    const leftMs = Math.max(0, this.#total - this.#done) / speed;
    this.#bar.update(this.#done, { left: Number.isFinite(leftMs) ? duration(leftMs) : "?", task });
  }

  stop() {
    this.#bar.stop();
  }
}
