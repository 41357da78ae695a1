/** The lock of a record: one process at a time appends to it. */
import { constants, copyFileSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { hostname } from "node:os";
import { isRecord } from "../values/kinds.js";
import { UsageError } from "./files.js";

/** The process that holds a lock. */
interface Owner {
  pid: number;
  host: string;
  since: string;
}

/**
 * Locks a record by a file beside it, `RECORD.lock`, which names its owner. The lock of a process that has ended is taken over.
 * @returns removes the lock, as does the end of the program
 * @throws {@link UsageError} if another process holds it
 */
export function lockRecord(flag: string, record: string): () => void {
  const lock = `${record}.lock`;
  const owner: Owner = { pid: process.pid, host: hostname(), since: new Date().toISOString() };
  try {
    while (!made(() => writeFileSync(lock, `${JSON.stringify(owner)}\n`, { flag: "wx" }))) {
      const found = ownerOf(lock);
      const reason = reasonToWait(found, lock);
      if (reason !== undefined) throw new UsageError(`${flag} ${record}: ${reason}`);
      takeOver(lock, found);
    }
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new UsageError(`${flag} ${record}: the lock ${lock} cannot be written: ${(error as Error).message}.`);
  }
  const release = () => {
    process.off("exit", release);
    if (isSame(ownerOf(lock), owner)) rmSync(lock, { force: true });
  };
  process.on("exit", release);
  return release;
}

/** Removes the lock of a process that has ended. */
function takeOver(lock: string, found: Owner | undefined): void {
  const aside = `${lock}.${process.pid}`;
  try {
    renameSync(lock, aside);
  } catch {
    // Another process was faster.
    return;
  }
  // What was moved may be the lock of a process that has taken over in between: it gets it back.
  if (!isSame(ownerOf(aside), found)) made(() => copyFileSync(aside, lock, constants.COPYFILE_EXCL));
  rmSync(aside, { force: true });
}

/** Why a lock may still be held; `undefined` if its process has ended. */
function reasonToWait(owner: Owner | undefined, lock: string): string | undefined {
  if (owner === undefined) return `${lock} names no process. Remove it if nothing writes the record.`;
  const { pid, host, since } = owner;
  const isElsewhere = host !== hostname();
  // An own number is that of an earlier process: this one has no lock yet.
  if (!isElsewhere && (pid === process.pid || !isRunning(pid))) return undefined;
  const remedy = `Wait for it, pass another file, or remove ${lock} if it does not run any more.`;
  return `process ${pid}${isElsewhere ? ` on ${host}` : ""} writes this record since ${since}. ${remedy}`;
}

function isRunning(pid: number): boolean {
  try {
    process.kill(pid, 0);
    return true;
  } catch (error) {
    return (error as NodeJS.ErrnoException).code === "EPERM";
  }
}

const isSame = (a: Owner | undefined, b: Owner | undefined) => a?.pid === b?.pid && a?.since === b?.since;

/** Makes a file; `false` if it is there. */
function made(make: () => void): boolean {
  try {
    make();
    return true;
  } catch (error) {
    if ((error as NodeJS.ErrnoException).code === "EEXIST") return false;
    throw error;
  }
}

function ownerOf(lock: string): Owner | undefined {
  try {
    const owner: unknown = JSON.parse(readFileSync(lock, "utf8"));
    return isRecord(owner) && typeof owner.pid === "number" ? (owner as unknown as Owner) : undefined;
  } catch {
    return undefined;
  }
}
