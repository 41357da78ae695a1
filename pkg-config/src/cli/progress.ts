/** Progress on a terminal: a line that is overwritten. */
import { printable } from "./terminal.js";

const eraseLine = "\r\u001b[2K";

/** The part of a stream that a line needs. */
type LineStream = Pick<NodeJS.WriteStream, "isTTY" | "columns" | "write">;

/** A line on a terminal; other streams get none. */
export class StatusLine {
  constructor(private readonly stream: LineStream) {}

  /** Replaces the line, cut to the width of the terminal. */
  show(text: string): void {
    if (!this.stream.isTTY) return;
    this.stream.write(eraseLine + printable(text).slice(0, Math.max(10, (this.stream.columns || 80) - 1)));
  }

  /** Clears the line before other output. */
  clear(): void {
    if (this.stream.isTTY) this.stream.write(eraseLine);
  }
}

const BAR_WIDTH = 24;
/** Other streams than terminals get a line for each tenth of a batch that is at least this long. */
const LONG = 20;

/** The progress of many cases: a bar on terminals, and some lines elsewhere. */
export class BatchProgress {
  readonly #line: StatusLine;
  readonly #begin = performance.now();
  #done = 0;
  #failed = 0;

  constructor(
    private readonly stream: LineStream,
    private readonly total: number,
  ) {
    this.#line = new StatusLine(stream);
    this.#draw();
  }

  #draw(): void {
    const full = Math.round((BAR_WIDTH * this.#done) / this.total);
    this.#line.show(`${"█".repeat(full)}${"░".repeat(BAR_WIDTH - full)} ${this.#state()}`);
  }

  /** Clears the bar before other output. */
  clear(): void {
    this.#line.clear();
  }

  /** Counts a case that is done. Its row may be written between `clear` and this. */
  add(isFailure: boolean): void {
    this.#done += 1;
    if (isFailure) this.#failed += 1;
    const isEnd = this.#done === this.total;
    const tenth = (done: number) => Math.floor((10 * done) / this.total);
    const isNews = this.total >= LONG && tenth(this.#done) > tenth(this.#done - 1);
    if (this.stream.isTTY && !isEnd) this.#draw();
    else if (this.stream.isTTY || isNews) this.stream.write(`${this.#state()}\n`);
  }

  #state(): string {
    const seconds = (performance.now() - this.#begin) / 1000;
    const counts = `${this.#done}/${this.total} cases  ${this.#failed} failed`;
    if (this.#done === 0) return counts;
    const rate = this.#done / Math.max(seconds, 1e-3);
    const speed = rate >= 1 ? `${rate.toFixed(1)} cases/s` : `${(1 / rate).toFixed(1)} s/case`;
    const left = this.total - this.#done;
    return `${counts}  ${speed}  ${left === 0 ? `took ${clock(seconds)}` : `${clock(left / rate)} left`}`;
  }
}

/** Hours, minutes and seconds: 1:02:03 or 2:03. */
function clock(seconds: number): string {
  const whole = Math.ceil(seconds);
  const two = (value: number) => String(value).padStart(2, "0");
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}
