/**
 * `npm run bench:colors [-- --set-seed N]`: what colour decides. Aligns generated coloured cases with their photo, and
 * without photo and colours.
 */
import { command, count } from "./command.mjs";
import { benchmarkRows, isWithin, loose, strict } from "./records.mjs";
import { fixed, markdownTable, mean, median, percent, share } from "./table.mjs";

/** @typedef {import("./records.mjs").BenchRecord} BenchRecord */
/** A case with colour and by its shape alone. @typedef {{ colored: BenchRecord, shape: BenchRecord }} Pair */

/** Classes whose print alone tells how an object is turned, and those whose colours must not change the pose. */
const told = ["printed", "blotted", "grey-photo"];
const untold = ["one-color", "wrong-colors"];
/** Confidence from which on callers trust a pose. */
const trusted = 0.9;

/** @param {BenchRecord} record */
const isTurnRight = ({ errors }) => !!errors && errors.rotationErrorDeg <= loose.rotationDeg;

/** @param {readonly Pair[]} pairs */
function successLine(/** @type {string} */ name, pairs) {
  const of = (/** @type {"shape" | "colored"} */ side, /** @type {(record: BenchRecord) => boolean} */ holds) =>
    percent(share(pairs.map((pair) => holds(pair[side]))));
  const cells = [
    isTurnRight,
    (/** @type {BenchRecord} */ { errors }) => isWithin(errors, strict),
    (/** @type {BenchRecord} */ { errors }) => isWithin(errors, loose),
  ].map((holds) => `${of("shape", holds)} → ${of("colored", holds)}`);
  return [name, pairs.length, ...cells];
}

/**
 * Whether two results are the same pose, exactly, or but for a turn that the symmetry of the case allows: then their
 * errors are alike.
 * @param {Pair} pair
 * @returns {"same" | "turned" | "other"}
 */
function change({ colored, shape }) {
  const [a, b] = [colored, shape].map(({ alignment }) => alignment);
  if (!a || !b) return a === b ? "same" : "other";
  const dot = Math.abs(a.rotation.reduce((sum, x, i) => sum + x * (b.rotation[i] ?? 0), 0));
  const degrees = (2 * Math.acos(Math.min(1, dot)) * 180) / Math.PI;
  if (degrees <= strict.rotationDeg && Math.abs(a.scale / b.scale - 1) <= strict.scale) return "same";
  const [e, f] = [colored.errors, shape.errors];
  const isAlike =
    !!e && !!f && Math.abs(e.rotationErrorDeg - f.rotationErrorDeg) < 2 && Math.abs(e.scaleError - f.scaleError) < 0.01;
  return isAlike ? "turned" : "other";
}

/** @param {readonly Pair[]} pairs */
function report(pairs) {
  const of = (/** @type {readonly string[]} */ classes) =>
    pairs.filter(({ colored }) => classes.includes(colored.class));
  const classes = [...new Set(pairs.map(({ colored }) => colored.class))].sort();
  const success = [
    ...classes.map((name) => successLine(name, of([name]))),
    successLine("print tells", of(told)),
    successLine("all", pairs),
  ];
  console.log(`\n${markdownTable(["shape → colour, %", "n", "turn", "strict", "loose"], success)}`);

  const kept = untold.map((name) => {
    const changes = of([name]).map(change);
    const among = (/** @type {string[]} */ ...kinds) => percent(share(changes.map((kind) => kinds.includes(kind))));
    return [name, changes.length, among("same"), among("same", "turned")];
  });
  console.log(`\n${markdownTable(["the pose of shape kept, %", "n", "same", "up to symmetry"], kept)}`);

  const sure = [
    ["with colour", pairs.map(({ colored }) => colored)],
    ["shape alone", pairs.map(({ shape }) => shape)],
  ];
  const lines = /** @type {[string, BenchRecord[]][]} */ (sure).map(([name, records]) => {
    const group = records.filter(({ alignment }) => (alignment?.confidence ?? 0) >= trusted);
    const within = (/** @type {typeof strict} */ tolerance) =>
      percent(share(group.map(({ errors }) => isWithin(errors, tolerance))));
    const confidence = fixed(mean(group.map(({ alignment }) => alignment?.confidence ?? 0)), 3);
    return [name, group.length, confidence, percent(share(group.map(isTurnRight))), within(strict), within(loose)];
  });
  const head = [`confidence ≥ ${trusted}`, "n", "mean confidence", "turn %", "strict %", "loose %"];
  console.log(`\n${markdownTable(head, lines)}`);
  const ratio = median(pairs.map(({ colored, shape }) => colored.seconds / shape.seconds));
  console.log(`\nTime with colour over time without: ${fixed(ratio, 2)} (median).`);
}

/** @param {import("./records.mjs").BenchOptions} options */
async function compare(options) {
  const rows = ["with colour:", "shape alone: color=false"];
  const [colored, shape] = await benchmarkRows({ ...options, set: "colors" }, rows);
  const others = new Map(shape?.records.map((record) => [record.name, record]));
  const pairs = (colored?.records ?? []).flatMap((record) => {
    const other = others.get(record.name);
    return other ? [{ colored: record, shape: other }] : [];
  });
  report(pairs);
  console.log(`
Turn: rotation within 20°, counted with the print where the print tells. Strict: scale within 5 %, rotation within 10°,
translation within 5 % of the diameter; loose: twice that; up to the symmetry of the shape where the print does not tell.`);
}

await command("bench:colors", (program) =>
  program
    .description("Compares alignments with photo and colours with those by shape alone, on generated coloured cases.")
    .option("--cases <n>", "generated cases", count, 144)
    .option("--set-seed <s>", "seed of the generated set", Number, 0)
    .option("--threads <n>", "all by default", count)
    .option("--json <file>", "keep everything about every case here", "target/bench/colors.json")
    .option("--from <file>", "run nothing, and read what an earlier run has kept")
    .action(compare),
);
