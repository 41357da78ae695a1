/** The example of a batch on a cluster: a queue, workers, and one that is killed. */
import assert from "node:assert/strict";
import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, renameSync, rmSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, test } from "node:test";
import { createAligner } from "sim3align";
import { examplesDir, filesOf, newFolder, printedBy, program, writeCase } from "../support/examples.js";
import { otherPose } from "../support/scene.js";

const name = "07-batch-on-a-cluster";
const CASES = 12;
const OPTIONS = { quality: "best" } as const;

const started: (() => unknown)[] = [];
after(async () => {
  for (const stop of started.reverse()) await stop();
});

async function stop(child: ChildProcess, signal: NodeJS.Signals): Promise<void> {
  if (child.exitCode !== null || child.signalCode !== null) return;
  child.kill(signal);
  await once(child, "exit");
}

/** Starts a program in the folder of the example, and collects the lines that it prints. */
function start(program: string, args: string[], env: NodeJS.ProcessEnv = {}) {
  const child = spawn(program, args, {
    cwd: join(examplesDir, name),
    env: { ...process.env, ...env },
    stdio: ["ignore", "pipe", "inherit"],
  });
  started.push(() => stop(child, "SIGKILL"));
  const lines: string[] = [];
  const reader = createInterface({ input: child.stdout }).on("line", (line) => lines.push(line));
  /** The second words of the lines with this first word. */
  const said = (word: string) =>
    lines.filter((line) => line.startsWith(`${word} `)).map((line) => line.split(" ")[1] ?? "");
  /** Waits until the lines are as wanted. */
  const until = async (isWanted: () => boolean) => {
    while (!isWanted()) await once(reader, "line");
  };
  return { child, lines, said, until };
}

const redisProgram = program(
  "REDIS_SERVER_PATH",
  "Redis",
  "install it (Debian and Ubuntu: apt-get install redis-server)",
);

interface Line {
  id: string;
  folder: string;
  matrix: number[];
  confidence: number;
  error?: string;
  attempts: number;
  frames?: { name: string; state: string }[];
}

/** Starts Redis, and returns the environment of the example's programs. */
async function startedRedis(): Promise<NodeJS.ProcessEnv> {
  const folder = newFolder();
  const socket = join(folder, "redis");
  const redis = start(redisProgram.path, ["--port", "0", "--unixsocket", socket, "--dir", folder, "--save", ""]);
  await redis.until(() => redis.lines.some((line) => /ready to accept connections/i.test(line)));
  return { REDIS_URL: socket, THREADS: "1", LOCK_MS: "2000" };
}

/** Runs a program of the example to its end, and returns what it prints. */
async function ran(script: string, args: string[], env: NodeJS.ProcessEnv): Promise<string[]> {
  return (await printedBy(`${name}/${script}`, args, env)).trim().split("\n");
}

/** Queues folders, and returns the ids of their jobs. */
const produced = async (args: string[], env: NodeJS.ProcessEnv) =>
  (await ran("producer.mjs", args, env)).map((line) => line.split(" ")[0] ?? "");

async function collected(env: NodeJS.ProcessEnv): Promise<{ results: Line[]; failures: Line[] }> {
  const lines = (await ran("collect.mjs", [], env)).map((line): Line => JSON.parse(line));
  const isFailure = ({ error }: Line) => error !== undefined;
  return { results: lines.filter((line) => !isFailure(line)), failures: lines.filter(isFailure) };
}

test("07: all results are there once, though a worker is killed in the middle of a job", {
  skip: redisProgram.skip,
  timeout: 240_000,
}, async () => {
  const env = await startedRedis();

  const parent = newFolder();
  const folders = Array.from({ length: CASES }, (_, i) => writeCase(parent, `case-${i}`, { pose: otherPose(i) }));
  const atFault = writeCase(parent, "at-fault", { isEmpty: true });
  const produce = (cases: string[]) => produced(["--options", JSON.stringify(OPTIONS), ...cases], env);
  const ids = await produce([...folders, atFault]);
  assert.equal(new Set(ids).size, CASES + 1);
  // Asked for again, and from a copy of the same files: the same jobs, and a line of its own for the copy.
  const copy = writeCase(parent, "copy-of-case-0", { pose: otherPose(0) });
  assert.deepEqual(await produce([...folders.slice(0, 3), copy]), [...ids.slice(0, 3), ids[0]]);

  // Storage that is away for a while.
  const [late = "", lateId = ""] = [folders.at(-1), ids[CASES - 1]];
  renameSync(late, `${late}-away`);
  const worker = () => start(process.execPath, ["worker.mjs"], env);
  // In its second job, the victim waits for a depth map that nobody writes.
  const [depth, away] = [join(folders[1] ?? "", "depth.npy"), join(parent, "depth.npy")];
  renameSync(depth, away);
  execFileSync("mkfifo", [depth]);
  const victim = worker();
  await victim.until(() => victim.said("active").length === 2);
  await stop(victim.child, "SIGKILL");
  renameSync(away, depth);
  const lost = victim.said("active").filter((id) => !victim.said("stored").includes(id));
  assert.deepEqual(lost, [ids[1]], `${victim.lines}`);
  const survivor = worker();

  await survivor.until(() => survivor.said("failed").includes(lateId));
  renameSync(`${late}-away`, late);

  const { results, failures } = await collected(env);
  assert.deepEqual(results.map(({ folder }) => folder).sort(), [...folders, copy].sort());
  assert.deepEqual(new Set(results.map(({ id }) => id)), new Set(ids.slice(0, CASES)));
  const stored = [...victim.said("stored"), ...survivor.said("stored")];
  assert.deepEqual(stored.sort(), ids.slice(0, CASES).sort(), "each result was stored once");
  assert.ok(survivor.said("active").includes(lost[0] ?? ""), "the survivor took over what was lost");

  const aligner = await createAligner({ workers: 1 });
  for (const result of results) {
    const direct = await aligner.align(filesOf(result.folder), OPTIONS);
    assert.deepEqual(result.matrix, [...direct.matrix], result.folder);
    assert.equal(result.confidence, direct.confidence);
  }

  // Bad input is not tried again; what is away is.
  assert.ok(survivor.said("active").filter((id) => id === lateId).length >= 2);
  assert.deepEqual(
    failures.map(({ folder, attempts }) => [folder, attempts]),
    [[atFault, 1]],
  );
  assert.match(failures[0]?.error ?? "", /^EMPTY_MASK: /);

  // The frames of a video come in the order of their numbers, and a failed job is done again where it is queued again.
  const video = join(parent, "video");
  mkdirSync(video);
  for (const k of [1, 2, 10]) writeCase(video, `frame_${k}`);
  renameSync(join(video, "frame_1", "mesh.obj"), join(video, "mesh.obj"));
  for (const k of [2, 10]) rmSync(join(video, `frame_${k}`, "mesh.obj"));
  const again = await produced([...["--options", JSON.stringify(OPTIONS)], atFault], env);
  assert.deepEqual(again, ids.slice(CASES));
  await produced([video], env);
  const after = await collected(env);
  const tracked = after.results.find(({ folder }) => folder === video);
  assert.deepEqual(
    tracked?.frames?.map(({ name, state }) => [name, state]),
    [1, 2, 10].map((k) => [`frame_${k}`, "tracking"]),
  );
  assert.equal(survivor.said("active").filter((id) => id === again[0]).length, 2);

  const ended = once(survivor.child, "exit");
  survivor.child.kill("SIGTERM");
  assert.deepEqual(await ended, [0, null], "a worker ends by itself when it is asked to");
});
