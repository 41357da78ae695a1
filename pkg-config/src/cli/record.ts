/** What of a batch is done: the cases in its record, by path, or by content where they have moved. */
import { existsSync } from "node:fs";
import { contentHash } from "./case-identity.js";
import type { CaseKey, RecordedEntry } from "./jsonl-file.js";
import type { Output } from "./output.js";

/** An entry of the record, with the case of this batch that it belongs to. */
export interface Resumed<T extends CaseKey> {
  task: T | undefined;
  /** Its name in this batch, or its own. */
  name: string;
  entry: RecordedEntry["entry"];
}

const keyOf = ({ path, name }: { path?: string | undefined; name: string }) => path ?? name;

/** The entries of the record of a batch, each with its case. The record is read twice, and not kept. */
export async function* resumedEntries<T extends CaseKey>(
  output: Output,
  tasks: readonly T[],
): AsyncGenerator<Resumed<T>, void, undefined> {
  const known = new Map(tasks.map((task) => [keyOf(task), task]));
  const moved = await movedEntries(output, known);
  const names = new Set(tasks.map(({ name }) => name));
  for await (const recorded of output.recorded()) {
    const key = keyOf(recorded);
    const task = known.get(key) ?? moved.get(key);
    const { name, entry } = recorded;
    // Another batch may have called another case so.
    yield { task, entry, name: task?.name ?? (names.has(name) ? key : name) };
  }
}

/** The cases that an entry does not find at its path, by the key of the entry. */
async function movedEntries<T extends CaseKey>(output: Output, known: ReadonlyMap<string, T>): Promise<Map<string, T>> {
  const left = new Map(known);
  const lost = new Map<string, string[]>();
  for await (const recorded of output.recorded()) {
    const { path, content } = recorded;
    if (left.delete(keyOf(recorded)) || path === undefined || content === undefined || existsSync(path)) continue;
    lost.set(content, [...(lost.get(content) ?? []), keyOf(recorded)]);
  }
  const moved = new Map<string, T>();
  if (lost.size === 0) return moved;
  for (const task of left.values()) {
    const content = task.folder === undefined ? undefined : contentHash(task.folder);
    const key = content === undefined ? undefined : lost.get(content)?.shift();
    if (key !== undefined) moved.set(key, task);
  }
  return moved;
}
