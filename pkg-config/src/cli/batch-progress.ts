/** The progress of many cases. */
import { type LineStream, StatusLine } from "./status-line.js";

const BAR_WIDTH = 24;
/** Other streams than terminals get a line for each tenth of a batch that is at least this long. */
const LONG = 20;

/** Shows a bar on terminals, and prints some lines elsewhere. */
export class BatchProgress {
  readonly #stream: LineStream;
  readonly #line: StatusLine;
  readonly #total: number;
  readonly #now: () => number;
  readonly #begin: number;
  #done = 0;
  #failed = 0;

  /** @param now a clock, milliseconds */
  constructor(stream: LineStream, total: number, now: () => number) {
    this.#stream = stream;
    this.#line = new StatusLine(stream);
    this.#total = total;
    this.#now = now;
    this.#begin = now();
  }

  /** Draws the bar, if there is one. */
  draw(): void {
    const full = Math.round((BAR_WIDTH * this.#done) / this.#total);
    const bar = "█".repeat(full) + "░".repeat(BAR_WIDTH - full);
    this.#line.show(`${bar} ${this.#state()}`);
  }

  /** Clears the bar before other output. */
  clear(): void {
    this.#line.clear();
  }

  /** Counts a case that is done. Its row may be written between `clear` and this. */
  add(isFailure: boolean): void {
    this.#done += 1;
    if (isFailure) this.#failed += 1;
    const isEnd = this.#done === this.#total;
    const tenth = (done: number) => Math.floor((10 * done) / this.#total);
    const isLong = this.#total >= LONG;
    if (this.#stream.isTTY && !isEnd) this.draw();
    else if (this.#stream.isTTY || (isLong && tenth(this.#done) > tenth(this.#done - 1)))
      this.#stream.write(`${this.#state()}\n`);
  }

  #state(): string {
    const seconds = (this.#now() - this.#begin) / 1000;
    const parts = [`${this.#done}/${this.#total} cases`, `${this.#failed} failed`];
    if (this.#done === 0) return parts.join("  ");
    const rate = this.#done / Math.max(seconds, 1e-3);
    parts.push(rate >= 1 ? `${rate.toFixed(1)} cases/s` : `${(1 / rate).toFixed(1)} s/case`);
    const left = this.#total - this.#done;
    parts.push(left === 0 ? `took ${clock(seconds)}` : `${clock(left / rate)} left`);
    return parts.join("  ");
  }
}

/** Hours, minutes and seconds: 1:02:03 or 2:03. */
function clock(seconds: number): string {
  const whole = Math.ceil(seconds);
  const two = (value: number) => String(value).padStart(2, "0");
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}
