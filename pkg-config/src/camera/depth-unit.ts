/** The unit of integer depth in a camera file. */
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import type { Meaning } from "./keys.js";
import type { CameraFileNames, Fact } from "./statements.js";

/** The unit that a camera file states. */
export interface StatedUnit {
  /** Metres per unit of integer depth. */
  metres: number;
  /** The key that states it. */
  key: string;
  /** Why it may be another unit. */
  doubt?: string;
}

/** Metres per unit that depth maps have: from a micrometre to whole metres. */
const PLAUSIBLE = { least: 1e-6, most: 1 } as const;

/** Values of `depth_scale` up to here are metres per unit, from there on units per metre; those between are millimetres per unit. */
const MAX_METRES = 0.01;
const MIN_PER_METRE = 100;

/** Keys of programs whose `depth_scale` is not in millimetres: RealSense's, Open3D's, nerfstudio's. */
const notBop = /^(ppx|ppy|coeffs|intrinsic_matrix|depth_format|color_format|fl_x|fl_y)$/;

const names: Record<string, number> = {
  m: 1,
  meter: 1,
  metre: 1,
  cm: 0.01,
  centimeter: 0.01,
  mm: 1e-3,
  millimeter: 1e-3,
  millimetre: 1e-3,
  um: 1e-6,
  micrometer: 1e-6,
  micrometre: 1e-6,
};

/** The metres in a text: `mm`, `0.1 mm`, `millimeters`. */
function lengthIn(text: string): number | undefined {
  const [, number = "1", name = ""] = /^(\d+(?:\.\d+)?)? ?([a-z]+?)s?$/.exec(text.trim().toLowerCase()) ?? [];
  const metres = names[name];
  return metres === undefined || Number(number) === 0 ? undefined : Number(number) * metres;
}

type Reading = "metresPerUnit" | "unitsPerMetre";

const words: Record<Reading, string> = { metresPerUnit: "metres per unit", unitsPerMetre: "units per metre" };

/** A value as metres per unit. */
const metresOf = (value: number, reading: Reading) => (reading === "metresPerUnit" ? value : 1 / value);

/**
 * The unit of integer depth that the facts of a camera file state.
 * @throws {@link Sim3AlignError} `INVALID_CAMERA` for a unit that is no number above 0
 */
export function unitOf(facts: readonly Fact[], { file }: CameraFileNames): StatedUnit | undefined {
  const stated = facts.flatMap((fact) => {
    const unit = unitOfFact(fact, facts, file);
    return unit === undefined ? [] : [unit];
  });
  const [first, ...more] = stated;
  const other = more.find(({ metres }) => Math.abs(Math.log(metres / (first as StatedUnit).metres)) > 0.01);
  if (first === undefined || other === undefined) return first;
  const doubt = `${file}: ${first.key} states ${metresText(first.metres)} a unit of depth, and ${other.key} ${metresText(other.metres)}. The first was used: remove the other.`;
  return { ...first, doubt };
}

function unitOfFact({ meaning, key, value }: Fact, facts: readonly Fact[], file: string): StatedUnit | undefined {
  if (!unitMeanings.has(meaning)) return undefined;
  const named = meaning === "unit" && typeof value === "string" ? lengthIn(value) : undefined;
  if (named !== undefined) return { metres: named, key };
  if (!isNumber(value) || value <= 0) {
    if (meaning === "scale") return undefined;
    const remedy = "Write metres per unit as depthScale, or BOP's millimetres per unit as depth_scale.";
    throw failure(
      "INVALID_CAMERA",
      `${file}.depthScale`,
      `${key} that is not a number above 0`,
      "a number above 0",
      remedy,
    );
  }
  if (meaning === "unit" || meaning === "metresPerUnit") return checked(key, value, "metresPerUnit", file);
  if (meaning === "unitsPerMetre") return checked(key, value, meaning, file);
  if (value <= MAX_METRES) return { metres: value, key };
  if (value >= MIN_PER_METRE) return { metres: 1 / value, key };
  // Of a scene, not of its depth.
  if (meaning === "scale") return undefined;
  const millimetres = { metres: value / 1000, key };
  const tool = facts.find((fact) => notBop.test(fact.key))?.key;
  if (tool === undefined && key === "depth_scale") return millimetres;
  const doubt = `${file}: ${key} ${value} was read as millimetres per unit of depth, as BOP writes depth_scale;${tool === undefined ? "" : ` beside ${tool},`} it may also be metres per unit or units per metre. Write metres per unit as depthScale.`;
  return { ...millimetres, doubt };
}

const unitMeanings: ReadonlySet<Meaning | undefined> = new Set<Meaning>([
  "metresPerUnit",
  "unitsPerMetre",
  "depthScale",
  "scale",
  "unit",
]);

/** A unit by its key, unless only the opposite reading is one of depth maps. */
function checked(key: string, value: number, stated: Reading, file: string): StatedUnit {
  const other = stated === "metresPerUnit" ? "unitsPerMetre" : "metresPerUnit";
  const isPlausible = (reading: Reading) => {
    const metres = metresOf(value, reading);
    return metres >= PLAUSIBLE.least && metres <= PLAUSIBLE.most;
  };
  if (isPlausible(stated)) return { metres: metresOf(value, stated), key };
  const reading = isPlausible(other) ? other : stated;
  const [first, second] = ([stated, other] as const).map(
    (one) => `${metresText(metresOf(value, one))} as ${words[one]}`,
  );
  const doubt = `${file}: a unit of depth by ${key} ${value} is ${first}, or ${second}: it was read as ${words[reading]}. Write metres per unit as depthScale.`;
  return { metres: metresOf(value, reading), key, doubt };
}

const metresText = (metres: number) => `${Number(metres.toPrecision(3))} m`;
