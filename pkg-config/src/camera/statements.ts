/** What a camera file states: its cameras, each with the facts that hold for it. */
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { type Meaning, meaningOf } from "./keys.js";

/** A key with its value; `meaning` is `undefined` for a key with numbers that is unknown. */
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
export function looksLikeMatrix(numbers: readonly number[]): boolean {
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
  const names = [...node.names, key];
  if (known?.meaning === "other" || names.length > MAX_LEVELS) return;
  const inner = isRecord(value) ? valueIn(value, known?.meaning) : value;
  if (isRecord(value) && inner === undefined) {
    node.children.push(nodeOf(value, names, `${path}.`, /^\d+$/.test(key)));
  } else if (Array.isArray(inner) && inner.some((item) => isRecord(item) || holdsRecord(item))) {
    node.children.push(...listed(inner, names, path));
  } else {
    const meaning = known?.meaning ?? (looksLikeMatrix(numbersOf(inner) ?? []) ? "matrix" : undefined);
    if (meaning === undefined && (!hasNumbers(inner) || isZero(inner))) return;
    const owner = known?.camera === undefined ? node : childOf(node, known.camera);
    owner.facts.push({ meaning, key, path, value: inner });
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

/** Facts that make an object a camera: numbers in pixels, else a field of view. */
const strong: ReadonlySet<Meaning | undefined> = new Set<Meaning>(["fx", "focal", "matrix"]);
const weak: ReadonlySet<Meaning | undefined> = new Set<Meaning>(["fovX", "fovY", "fov"]);

/** The outermost objects with facts of these meanings, each with the objects around it. */
function camerasIn(node: Node, meanings: typeof strong, around: readonly Node[] = []): Node[][] {
  const here = [...around, node];
  if (node.facts.some(({ meaning }) => meanings.has(meaning))) return [here];
  return node.children.flatMap((child) => camerasIn(child, meanings, here));
}

/** The facts of an object and of those in it that are no cameras themselves. */
function factsOf(node: Node, isCamera: (node: Node) => boolean): Fact[] {
  const parts = node.children.filter((child) => !isCamera(child));
  const inner = parts.flatMap((child) => factsOf(child, isCamera));
  // Of the entries of a list, what is unknown is not of the camera.
  return [...node.facts, ...inner].filter(({ meaning }) => meaning !== undefined || !node.isListed || isCamera(node));
}

/** All cameras that the content of a file states. */
export function camerasOf(content: Record<string, unknown>): CameraPlace[] {
  const root = nodeOf(content, [], "");
  const found = camerasIn(root, strong);
  const places = found.length > 0 ? found : camerasIn(root, weak);
  const cameras = new Set(places.map((path) => path.at(-1)));
  const holds = (node: Node): boolean => cameras.has(node) || node.children.some(holds);
  return places.map((path) => {
    const own = path.at(-1) as Node;
    const facts = [...path]
      .reverse()
      .flatMap((node) => factsOf(node, node === own ? (child) => child !== own && strongIn(child) : holds));
    return { names: own.names, facts };
  });
}

/** Whether an object inside a camera is another one. */
const strongIn = (node: Node): boolean =>
  node.isListed || node.facts.some(({ meaning }) => strong.has(meaning)) || node.children.some(strongIn);
