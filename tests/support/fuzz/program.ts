/** `npm run fuzz` runs this: program.js MINUTES SEED. It prints what it tried, and every finding with its seed. */
import { type Target, targets } from "./fuzzer.js";

/** Findings of the same words are one; after so many, the search ends. */
const MAX_FINDINGS = 20;

const [minutes = 1, first = 0] = process.argv.slice(2).map(Number);
const { calls, storms, sideBySide, conventions, end } = await targets();
const findings = new Map<string, string>();
const counts = { calls: 0, conventions: 0, storms: 0, sideBySide: 0 };
let made = 0;
// A rejection that nobody handles is a finding of the target that runs.
const until = performance.now() + 60_000 * minutes;

async function run(name: keyof typeof counts, target: Target, seed: number): Promise<void> {
  counts[name] += 1;
  try {
    made += await target(seed);
  } catch (error) {
    const { message, cause } = error as Error;
    const words = message.replace(/\d+/g, "N");
    if (!findings.has(words)) console.log(error);
    findings.set(words, `${message}${cause instanceof Error && cause.cause ? ` (${cause.cause})` : ""}`);
  }
}

for (let seed = first + 1; performance.now() < until && findings.size < MAX_FINDINGS; seed++) {
  await run("calls", calls, seed);
  // These take a hundredth of the time.
  for (let i = 0; i < 20; i++) await run("conventions", conventions, 20 * seed + i);
  if (seed % 5 === 0) await run("sideBySide", sideBySide, seed);
  // A storm takes as long as many calls.
  if (seed % 50 === 0) await run("storms", storms, seed);
}
await end();
const executions = Object.entries(counts).map(([name, count]) => `${count} of ${name}`);
console.log(`Executions: ${executions.join(", ")}; ${made} calls, ${findings.size} findings; seeds from ${first + 1}`);
for (const finding of findings.values()) console.log(`- ${finding}`);
if (findings.size > 0) process.exitCode = 1;
