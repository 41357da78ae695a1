/** The lock of a record: one process at a time appends to it. */
import { readFileSync, readlinkSync, rmSync, utimesSync, writeFileSync } from "node:fs";
import { hostname } from "node:os";
import { isRecord } from "../values/kinds.js";
import { isFile, statOf, UsageError } from "./files.js";
import { OutputError } from "./output-file.js";
import type { OutputName } from "./run-files.js";

/** The lock of a record, as an output of the run: another file of this name stays. */
export const lockOf = (record: string): OutputName => ({
  ...{ flag: "the lock of --jsonl", path: `${record}.lock` },
  isOwn: (beginning) => '{"pid":'.startsWith(beginning.slice(0, 7)),
});

/** The process that holds a lock. */
interface Owner {
  pid: number;
  /** The system in which `pid` is a process: a boot of a machine, and a container. */
  system: string;
  /** Its start, because numbers of processes are used again; empty where the system has no such time. */
  started: string;
  since: string;
}

/** Seconds between the marks of a holder, and without a mark until it counts as ended. */
const [MARKED_S, ENDED_S] = [20, 300];

/** A lock that is held. */
export interface RecordLock {
  /** @throws {@link OutputError} if another process has taken the lock over, such as after a long sleep of this one */
  check(): void;
  /** Removes the lock, as does the end of the program. */
  release(): void;
}

/**
 * Locks a record by a file beside it, `RECORD.lock`, which names its owner and which it marks as long as it runs. The lock
 * of a process that has ended is taken over: at once if it was one of this system, otherwise, or if the lock cannot be
 * read, five minutes after the last mark.
 * @throws {@link UsageError} if another process holds it, {@link OutputError} if it cannot be written
 */
export function lockRecord(flag: string, record: string): RecordLock {
  const { path: lock } = lockOf(record);
  const { pid } = process;
  const owner: Owner = { pid, system: system(), started: startOf(pid) ?? "", since: new Date().toISOString() };
  const text = `${JSON.stringify(owner)}\n`;
  const isHeld = () => isSame(ownerOf(lock), owner);
  try {
    for (let tries = 0; !isHeld(); tries++) {
      if (tries > 9) throw new Error("it does not stay");
      const found = statOf(lock);
      const reason = found === undefined ? undefined : reasonToWait(ownerOf(lock), found.mtimeMs, owner);
      if (reason !== undefined)
        throw new UsageError(`${flag} ${record}: ${reason} Or remove ${lock}, if it does not run any more.`);
      rmSync(lock, { force: true });
      make(lock, text);
    }
  } catch (error) {
    if (error instanceof UsageError) throw error;
    throw new OutputError(`${flag} ${record}: the lock ${lock} cannot be written: ${(error as Error).message}.`);
  }
  const mark = setInterval(() => {
    try {
      if (isHeld()) utimesSync(lock, new Date(), new Date());
    } catch {
      // Without marks, the lock can be taken over, which the next line of the record finds out.
    }
  }, 1000 * MARKED_S).unref();
  const release = () => {
    clearInterval(mark);
    process.off("exit", release);
    if (isHeld()) rmSync(lock, { force: true });
  };
  process.on("exit", release);
  const check = () => {
    // It may have been removed by hand.
    if (!isHeld()) make(lock, text);
    if (!isHeld()) throw new OutputError(`${flag} ${record}: another process has taken over ${lock}.`);
  };
  return { check, release };
}

/** Makes a file, unless there is one. */
function make(path: string, text: string): void {
  try {
    writeFileSync(path, text, { flag: "wx" });
  } catch (error) {
    if ((error as NodeJS.ErrnoException).code === "EEXIST") return;
    rmSync(path, { force: true });
    throw error;
  }
}

/** Why a lock may still be held; `undefined` if its process has ended. */
function reasonToWait(owner: Owner | undefined, markedMs: number, own: Owner): string | undefined {
  if (owner?.system === own.system) {
    const { pid, started, since } = owner;
    // Another process has the number of the one that has ended, if it started at another time.
    if (pid === own.pid || startOf(pid) !== started) return undefined;
    return `process ${pid} writes this record since ${since}. Wait for it, or pass another file.`;
  }
  const restS = Math.ceil(ENDED_S - (Date.now() - markedMs) / 1000);
  if (restS <= 0) return undefined;
  const holder = owner === undefined ? "a process" : `process ${owner.pid} of another system (since ${owner.since})`;
  return `${holder} writes this record. Its lock ends in ${restS} s, if it has ended.`;
}

/** On Linux, the boot and the namespace of processes, which differs between containers; elsewhere, the machine. */
function system(): string {
  try {
    const boot = readFileSync("/proc/sys/kernel/random/boot_id", "utf8").trim();
    return `${boot} ${readlinkSync("/proc/self/ns/pid")}`;
  } catch {
    return hostname();
  }
}

/** The start of a process, on Linux in ticks since the boot; `undefined` if it does not run. */
function startOf(pid: number): string | undefined {
  try {
    process.kill(pid, 0);
  } catch (error) {
    if ((error as NodeJS.ErrnoException).code !== "EPERM") return undefined;
  }
  try {
    // The second field is a name in parentheses, which may hold anything.
    return readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\)/s, "").split(" ")[20] ?? "";
  } catch {
    return "";
  }
}

const isSame = (a: Owner | undefined, b: Owner) => a?.pid === b.pid && a.system === b.system && a.since === b.since;

function ownerOf(lock: string): Owner | undefined {
  try {
    const owner: unknown = isFile(lock) ? JSON.parse(readFileSync(lock, "utf8")) : undefined;
    return isRecord(owner) && typeof owner.pid === "number" && typeof owner.system === "string"
      ? (owner as unknown as Owner)
      : undefined;
  } catch {
    return undefined;
  }
}
