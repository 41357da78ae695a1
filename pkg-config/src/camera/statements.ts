/** The cameras in a camera file, each with the facts that hold for it. */
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { isOther, type Meaning, meaningOf } from "./keys.js";
import { projectionOf } from "./projection.js";

/** The names of a camera file and of its options in errors. */
export interface CameraFileNames {
  file: string;
  /** Prefix of the names of options. */
  options: "" | "options.";
}

const forms =
  "{ fx, fy, cx, cy }, { K } or another name of a 3 × 3, 3 × 4 or 4 × 4 matrix, { fovYDeg }, a BOP scene_camera.json, or the numbers as text";

/** The error for JSON that is not the content of a camera file. */
export function noCamera({ file }: Pick<CameraFileNames, "file">, found: string) {
  const remedy = "Write the focal lengths and the principal point as fx, fy, cx and cy, in pixels of the depth map.";
  return failure("INVALID_CAMERA", file, found, forms, remedy);
}

/** A key with its value; `meaning` is `undefined` for a key with numbers that is not in the table. */
export interface Fact {
  meaning: Meaning | undefined;
  /** The key as the file has it. */
  key: string;
  /** The key with those around it. */
  path: string;
  value: unknown;
}

/** A camera in a file, by its place: `left_cam`, `cameras.2`. */
export interface CameraPlace {
  /** The keys around it, and its name if it states one. */
  names: readonly string[];
  /** Its facts, the nearest ones first. */
  facts: readonly Fact[];
}

/** An object in a file. */
interface Node {
  names: readonly string[];
  facts: Fact[];
  children: Node[];
  /** Whether it is one of a list or of several with numbers for names, such as the frames of a video. */
  isListed: boolean;
}

/** Objects in a file are at most as deep. */
const MAX_LEVELS = 8;

/** Whether nine, twelve or sixteen numbers are a matrix of intrinsics, by rows or by columns. */
function looksLikeMatrix(numbers: readonly number[]): boolean {
  const side = { 9: 3, 12: 4, 16: 4 }[numbers.length];
  if (side === undefined) return false;
  const at = (row: number, column: number) => numbers[side * row + column] as number;
  const isCamera = (cx: number, cy: number, x: number, y: number) => cx > 0 && cy > 0 && x === 0 && y === 0;
  const isFocal = at(0, 0) > 0 && at(1, 1) > 0 && at(1, 0) === 0 && at(2, 2) === 1 && Math.max(at(0, 0), at(1, 1)) > 10;
  return (
    isFocal && (isCamera(at(0, 2), at(1, 2), at(2, 0), at(2, 1)) || isCamera(at(2, 0), at(2, 1), at(0, 2), at(1, 2)))
  );
}

/** All numbers in nested lists; `undefined` for anything else. */
export function numbersOf(value: unknown): number[] | undefined {
  if (!Array.isArray(value)) return undefined;
  const numbers: unknown[] = value.flat(MAX_LEVELS);
  return numbers.length > 0 && numbers.every(isNumber) ? numbers : undefined;
}

/** The value that a record stands for: OpenCV's `{ rows, cols, data }`, Unity's `{ x, y }`, coefficients by other names. */
function valueIn(record: Record<string, unknown>, meaning: Meaning | undefined): unknown {
  if (meaning === "region") return record;
  if (record.data !== undefined) return record.data;
  const values = Object.values(record);
  if (isNumber(record.x) && isNumber(record.y) && values.length === 2) return values;
  const isNamed = Object.entries(record).some(([key, value]) => meaningOf(key, value)?.meaning === "coefficient");
  return meaning === "distortion" && !isNamed ? (numbersOf(values) ?? undefined) : undefined;
}

const hasNumbers = (value: unknown) => isNumber(value) || numbersOf(value) !== undefined;
const isZero = (value: unknown) => [numbersOf(value) ?? value].flat().every((number) => number === 0);

function nodeOf(record: Record<string, unknown>, names: readonly string[], path: string, isListed = false): Node {
  const node: Node = { names, facts: [], children: [], isListed };
  for (const [key, value] of Object.entries(record)) addTo(node, key, value, `${path}${key}`);
  return node;
}

/** Adds what a key states to an object: a fact, or other objects. */
function addTo(node: Node, key: string, value: unknown, path: string): void {
  const known = meaningOf(key, value);
  if (node.names.length >= MAX_LEVELS) return;
  const inner = isRecord(value) ? valueIn(value, known?.meaning) : value;
  const isPart = isRecord(value) && inner === undefined;
  if (isPart || (Array.isArray(inner) && inner.some((item) => isRecord(item) || holdsRecord(item)))) {
    if (known === undefined && isOther(key, value)) return;
    const names = [...node.names, key];
    const parts = isPart
      ? [nodeOf(value, names, `${path}.`, /^\d+$/.test(key))]
      : listed(inner as unknown[], names, path);
    for (const part of parts) node.children.push(part);
  } else {
    const numbers = numbersOf(inner) ?? [];
    const projection = projectionOf(numbers);
    const meaning = projection ? "projection" : (known?.meaning ?? (looksLikeMatrix(numbers) ? "matrix" : undefined));
    if (meaning === undefined && (!hasNumbers(inner) || isZero(inner))) return;
    const owner = known?.camera === undefined ? node : childOf(node, known.camera);
    owner.facts.push({ meaning, key, path, value: projection ?? inner });
  }
}

const holdsRecord = (value: unknown) => Array.isArray(value) && value.some(isRecord);

/** The objects in a list, also as pairs of a number and an object. */
const listed = (list: readonly unknown[], names: readonly string[], path: string): Node[] =>
  list.flatMap((item, i) => {
    const [label, value] = Array.isArray(item) && item.length === 2 && isRecord(item[1]) ? item : [i, item];
    if (!isRecord(value)) return [];
    const own = [
      value.image_id,
      value.id,
      value.camera_id,
      value.img_name,
      value.file_path,
      value.camera_name,
      value.name,
    ];
    const named = own.filter((name) => typeof name === "string" || isNumber(name)).map(String);
    return [nodeOf(value, [...names, `${label}`, ...named], `${path}[${label}].`, true)];
  });

function childOf(node: Node, name: string): Node {
  const known = node.children.find(({ names }) => names.at(-1) === name);
  if (known !== undefined) return known;
  const child: Node = { names: [...node.names, name], facts: [], children: [], isListed: false };
  node.children.push(child);
  return child;
}

/** Facts that make an object a camera: numbers in pixels, else a field of view or a projection. */
const strong: ReadonlySet<Meaning | undefined> = new Set<Meaning>(["fx", "focal", "matrix"]);
const weak: ReadonlySet<Meaning | undefined> = new Set<Meaning>(["fovX", "fovY", "fov", "projection"]);

/** Facts of the objects around a camera that count for it, with a meaning and without: more are in no file of cameras. */
const MAX_SHARED = 32;

const isAny = (node: Node, meanings: typeof strong) => node.facts.some(({ meaning }) => meanings.has(meaning));

/** Whether an object inside a camera is another one. */
const isOtherCamera = (node: Node): boolean =>
  node.isListed || isAny(node, strong) || node.children.some(isOtherCamera);

/** The facts of an object and of its parts. */
const factsOf = (node: Node): Fact[] => [
  ...node.facts,
  ...node.children.flatMap((child) => (isOtherCamera(child) ? [] : factsOf(child))),
];

/** The outermost cameras in an object, each with the facts of what is around it. */
function camerasIn(node: Node, meanings: typeof strong): CameraPlace[] {
  if (isAny(node, meanings)) return [{ names: node.names, facts: factsOf(node) }];
  const inner = node.children.map((child) => ({ child, cameras: camerasIn(child, meanings) }));
  const around = inner.flatMap(({ child, cameras }) => (cameras.length > 0 ? [] : factsOf(child)));
  const cameras = inner.flatMap((part) => part.cameras);
  if (cameras.length === 0) return [];
  const all = [...node.facts, ...around];
  const shared = [true, false].flatMap((hasMeaning) =>
    all.filter(({ meaning }) => (meaning !== undefined) === hasMeaning).slice(0, MAX_SHARED),
  );
  return shared.length === 0 ? cameras : cameras.map(({ names, facts }) => ({ names, facts: [...facts, ...shared] }));
}

/** All cameras that the content of a file states. */
export function camerasOf(content: Record<string, unknown>): CameraPlace[] {
  const root = nodeOf(content, [], "");
  const found = camerasIn(root, strong);
  return found.length > 0 ? found : camerasIn(root, weak);
}
