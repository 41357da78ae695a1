/** The progress of a batch, on terminals and elsewhere. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { sourceModule } from "../support/internals.js";

interface Progress {
  draw(): void;
  clear(): void;
  add(isFailure: boolean): void;
}

type Stream = { isTTY: boolean; columns: number; write(text: string): void };

const { BatchProgress }: { BatchProgress: new (stream: Stream, total: number, now: () => number) => Progress } =
  await sourceModule("cli/batch-progress.js");

/** What a batch shows whose cases take two seconds each, of which some fail. */
function shown(total: number, failures: readonly number[], isTTY: boolean, columns = 100): string[] {
  const written: string[] = [];
  let time = 0;
  const progress = new BatchProgress({ isTTY, columns, write: (text) => written.push(text) }, total, () => time);
  progress.draw();
  for (let i = 0; i < total; i++) {
    time += 2000;
    progress.clear();
    progress.add(failures.includes(i));
  }
  return written;
}

test("a terminal shows a bar with rate, time left and failures, and at the end what it took", () => {
  const erase = "\r\u001b[2K";
  assert.deepEqual(shown(3, [1], true), [
    `${erase}${"░".repeat(24)} 0/3 cases  0 failed`,
    erase,
    `${erase}${"█".repeat(8)}${"░".repeat(16)} 1/3 cases  0 failed  2.0 s/case  0:04 left`,
    erase,
    `${erase}${"█".repeat(16)}${"░".repeat(8)} 2/3 cases  1 failed  2.0 s/case  0:02 left`,
    erase,
    "3/3 cases  1 failed  2.0 s/case  took 0:06\n",
  ]);
  for (const text of shown(3, [], true, 30).slice(0, -1)) assert.ok(text.length < 30 + erase.length);
});

test("elsewhere, a batch prints a line per tenth, and a short one nothing", () => {
  assert.deepEqual(shown(19, [], false), []);
  const lines = shown(4000, [0, 399], false);
  assert.equal(lines.length, 10);
  assert.equal(lines[0], "400/4000 cases  2 failed  2.0 s/case  2:00:00 left\n");
  assert.equal(lines[9], "4000/4000 cases  2 failed  2.0 s/case  took 2:13:20\n");
});
