/** Camera files that are no JSON: numbers, named values, YAML, INI, XML, COLMAP's cameras.txt, NPY. */
import { failure } from "../values/error.js";
import { isNumber } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import { npyNumbers } from "./npy-numbers.js";

type Content = Record<string, unknown>;

/** Longest text of a camera file, of one in XML, and longest line that may hold several values. */
const MAX_TEXT = 1 << 18;
const MAX_XML = 1 << 16;
const MAX_LINE = 1 << 12;

const numeral = "[-+]?(?:\\d{1,40}(?:\\.\\d{0,40})?|\\.\\d{1,40})(?:e[-+]?\\d{1,4})?";
const ending = "(?![\\w.])";

/**
 * The content of a camera file that is no JSON, as the JSON with the same meaning.
 * @param broken the error of JSON, for a text that begins as JSON
 * @throws {@link Sim3AlignError} `UNSUPPORTED_FORMAT` for a form that is not known, `broken` for broken JSON
 */
export function cameraContent(argument: string, content: Uint8Array | string, broken: unknown): unknown {
  const beginning = typeof content === "string" ? "" : String.fromCharCode(...content.subarray(0, 6));
  if (beginning === "\x93NUMPY") return ofArray(argument, content as Uint8Array);
  const text = (typeof content === "string" ? content : new TextDecoder().decode(content)).replace(/^\ufeff/, "");
  const read = text.length > MAX_TEXT ? undefined : cameraText(text);
  if (read !== undefined) return read;
  if (/^\s*[{[]/.test(text)) throw broken;
  const first = text.trim().slice(0, 40).replace(/\s+/g, " ");
  const kind = Object.entries(binary).find(([, magic]) => first.startsWith(magic))?.[0];
  // biome-ignore lint/suspicious/noControlCharactersInRegex: files that are no text
  const isText = !/[\0-\x08\ufffd]/.test(first);
  const other = isText ? `text that begins with ${JSON.stringify(first)}` : "bytes that are no text";
  const found = kind ?? (first === "" ? "nothing" : other);
  const expected =
    "JSON, YAML, XML or INI with intrinsics, COLMAP's cameras.txt, the numbers of K as text, or K as NPY";
  const remedy =
    "Write the focal lengths and the principal point as a text of four numbers, fx fy cx cy, in pixels of the depth map.";
  throw failure("UNSUPPORTED_FORMAT", argument, found, expected, remedy);
}

/** Files that may hold a camera, by their first bytes. */
const binary = {
  "a ZIP archive, such as NPZ": "PK",
  HDF5: "\ufffdHDF",
  "a MAT-file": "MATLAB",
  "a picture": "\ufffdPNG",
};

function ofArray(argument: string, bytes: Uint8Array): unknown {
  const matrices = npyNumbers(bytes);
  const [first, ...others] = matrices ?? [];
  if (first !== undefined && others.every((matrix) => `${matrix}` === `${first}`)) return { K: first };
  const what = first === undefined ? "that is no small array of numbers" : `of ${others.length + 1} matrices`;
  const remedy = 'Save one: numpy.save("K.npy", K.astype(float)).';
  throw failure("UNSUPPORTED_FORMAT", argument, `an NPY file ${what}`, "one matrix K", remedy);
}

/** The camera in a text; `undefined` if it is another text, or nested too deep. */
function cameraText(text: string): unknown {
  try {
    return textOfForms(text);
  } catch (error) {
    if (error instanceof RangeError) return undefined;
    throw error;
  }
}

/** The content of a text in the form that it has. */
function textOfForms(text: string): unknown {
  const content = text
    .replace(/^%YAML.*$/gm, "")
    .replace(/(^|\s)(#|\/\/).*$/gm, "")
    // A name and its numbers, without a sign between them.
    .replace(/^([A-Za-z_]\w*)[ \t]+(?=[-+.\d][-+.\de\s]*$)/gm, "$1: ");
  return (
    ofXml(text) ??
    ofPython(content) ??
    colmap(content) ??
    realSense(content) ??
    ofNumbers(content) ??
    ofStereo(ofLines(content))
  );
}

/** Numbers with spaces, commas, semicolons or brackets between them, also as NumPy prints them. */
function numbersIn(whole: string): number[] | undefined {
  const text = whole.replace(/, *(?:device|grad_fn|requires_grad)=[^,)]*/g, "");
  const rest = text.replace(
    new RegExp(`${numeral}${ending}|\\b(?:np|numpy|array|matrix|tensor|dtype|float\\d*)\\b|[\\s,;()[\\]=.]`, "gi"),
    "",
  );
  if (rest !== "") return undefined;
  const numbers = (text.replace(/float\d+/g, "").match(new RegExp(numeral, "gi")) ?? []).map(Number);
  return numbers.length > 0 && numbers.every(isNumber) ? numbers : undefined;
}

/** A matrix, with the baseline of a pair of cameras behind it or not; four numbers; or these with the size of the image. */
function ofNumbers(text: string): unknown {
  // Spreadsheets name their columns.
  const header = /^\s*"?[A-Za-z_]\w*"?(?:[\t ,;]+"?[A-Za-z_]\w*"?)+[\t ]*$/m.exec(text)?.[0] ?? "";
  const columns = header.match(/\w+/g) ?? [];
  const numbers = numbersIn(text.replace(header, ""));
  if (numbers === undefined) return undefined;
  if (columns.length > 0) {
    const entries = columns.map((name, i) => [name, numbers[i]]);
    return columns.length === numbers.length ? Object.fromEntries(entries) : undefined;
  }
  const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0] = numbers;
  // FoundationStereo writes the baseline in a second line.
  if (numbers.length === 10 && numbers[8] === 1) return { K: numbers.slice(0, 9) };
  if (numbers.length !== 6) return numbers;
  const offCentre = (cx: number, cy: number, width: number, height: number) =>
    width % 1 === 0 && height % 1 === 0 ? Math.max(Math.abs(cx / width - 0.5), Math.abs(cy / height - 0.5)) : 1;
  // ARKitScenes' .pincam has the size first, H2O's text behind the intrinsics.
  const [before, behind] = [offCentre(e, f, a, b), offCentre(c, d, e, f)];
  if (Math.min(before, behind) > 0.3) return numbers;
  return before < behind
    ? { width: a, height: b, fx: c, fy: d, cx: e, cy: f }
    : { fx: a, fy: b, cx: c, cy: d, width: e, height: f };
}

/** A dictionary as Python prints it, or a mapping of YAML in braces. */
function ofPython(text: string): unknown {
  if (!/^\s*[{[]/.test(text)) return undefined;
  const json = text
    .replace(/\b(?:np\.|numpy\.)?(?:array|float\d*)\(/g, "(")
    .replace(/,? ?dtype=\w+/g, "")
    .replace(/[()]/g, (bracket) => (bracket === "(" ? "[" : "]"))
    .replaceAll("'", '"')
    .replace(/([{,]\s*)([A-Za-z_]\w*)\s*:/g, '$1"$2":')
    .replace(/\bTrue\b/g, "true")
    .replace(/\bFalse\b/g, "false")
    .replace(/\b(?:None|NaN|nan)\b/g, "null")
    .replace(/(\d)\.(?=[\s,\]}])/g, "$1")
    .replace(/,(\s*[\]}])/g, "$1");
  try {
    return JSON.parse(json);
  } catch {
    return undefined;
  }
}

/** COLMAP's models with one focal length. */
const oneFocal = /^(SIMPLE_|RADIAL)/;

/** `CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS` a line; the centre of COLMAP's first pixel is at 0.5. */
function colmap(text: string): Content | undefined {
  const lines = text.split(/\r?\n/).filter((line) => line.trim() !== "");
  const cameras = lines.map((line) => {
    const [id = "", model = "", ...rest] = line.trim().split(/\s+/);
    const [width, height, ...parameters] = rest.map(Number);
    if (!/^\d+$/.test(id) || !/^[A-Z][A-Z_]+$/.test(model) || !parameters.every(isNumber) || parameters.length < 3)
      return undefined;
    const [fx, fy, cx, cy, ...D] = oneFocal.test(model) ? [parameters[0], ...parameters] : parameters;
    return [id, { camera_model: model, width, height, fx, fy, cx: Number(cx) - 0.5, cy: Number(cy) - 0.5, D }] as const;
  });
  return cameras.length > 0 && cameras.every((camera) => camera !== undefined)
    ? Object.fromEntries(cameras)
    : undefined;
}

/** What librealsense prints: `[ 640x480  p[320 240]  f[600 600]  Brown Conrady [0 0 0 0 0] ]`. */
function realSense(text: string): Content | undefined {
  const [, width, height, p = "", f = "", model, D = ""] =
    /^\[? ?(\d+)x(\d+) p\[([^\]]*)\] f\[([^\]]*)\] ([\w ]*?) ?\[([^\]]*)\] ?\]?$/.exec(
      text.trim().replace(/\s+/g, " "),
    ) ?? [];
  if (width === undefined) return undefined;
  const size = { width: Number(width), height: Number(height) };
  return { ...size, principal_point: numbersIn(p), focal: numbersIn(f), model, coeffs: numbersIn(D) ?? [] };
}

/** Elements with text or elements in them, as OpenCV's FileStorage writes XML; attributes do not matter. */
function ofXml(text: string): Content | undefined {
  if (text.length > MAX_XML || !/^\s*<[?\w!]/.test(text)) return undefined;
  const element = /<([A-Za-z_][\w.-]*)[^>]*>([\s\S]*?)<\/\1>/g;
  const elementValue = (inner: string): unknown => {
    const parts = [...inner.matchAll(element)];
    return parts.length === 0
      ? scalar(inner.trim())
      : Object.fromEntries(parts.map(([, name = "", part = ""]) => [name, elementValue(part)]));
  };
  const value = elementValue(text.replace(/<[?!][\s\S]*?>/g, ""));
  return isRecord(value) ? value : undefined;
}

/** The value in a line: numbers, a flow list or mapping, or a text. */
function scalar(text: string): unknown {
  const value = text.replace(/^!!?[\w:-]*\s*/, "").replace(/[,;]$/, "");
  const numbers = numbersIn(value);
  if (numbers !== undefined) return numbers.length === 1 && !value.startsWith("[") ? numbers[0] : numbers;
  if (/^\[\s*\]$/.test(value)) return [];
  const inner = /^\{(.*)\}$/s.exec(value)?.[1];
  if (inner !== undefined) return ofLines(inner.replace(/,(?![^[]*\])/g, "\n")) ?? value;
  return value.replace(/^(["'])(.*)\1$/, "$2");
}

/** Lines of `key: value` or `key = value`, several in a line as well; blocks of YAML by indentation, sections of INI by name. */
function ofLines(text: string): Content | undefined {
  const lines = linesOf(text);
  const [value, next] = mapping(lines, 0, 0, false);
  return next === lines.length && Object.keys(value).length > 0 ? value : undefined;
}

interface Line {
  indent: number;
  line: string;
}

/** The value of a block, and the line behind it. */
type Block<T> = [value: T, next: number];

const isItem = (line: Line | undefined): boolean => line !== undefined && /^-(\s|$)/.test(line.line);

/** A mapping of YAML, or the lines of a section of INI. */
function mapping(lines: Line[], begin: number, indent: number, isSection: boolean): Block<Content> {
  const value: Content = {};
  let at = begin;
  for (let line = lines[at]; line !== undefined && line.indent >= indent; line = lines[at]) {
    const section = /^\[([A-Za-z0-9_][\w. -]*)\]$/.exec(line.line)?.[1];
    if (section !== undefined && isSection) break;
    const [, key, text = ""] = /^["']?([A-Za-z0-9_][\w. -]*?)["']?\s*[:=]\s*(.*)$/.exec(line.line) ?? [];
    at++;
    if (section !== undefined) [value[section], at] = mapping(lines, at, indent, true);
    else if (key !== undefined) {
      const [inner, next] = text === "" || isTag(text) ? block(lines, at, line.indent) : [scalar(text), at];
      if (!(key in value)) value[key] = inner;
      at = next;
    }
    // Titles do not matter.
    else if (isItem(line) || /\d/.test(line.line)) return [value, begin];
  }
  return [value, at];
}

/** What is below a key: a list, whose items may stand below the key itself, or a mapping. */
function block(lines: Line[], at: number, indent: number): Block<unknown> {
  const line = lines[at];
  if (line === undefined) return ["", at];
  if (isItem(line) && line.indent >= indent) return list(lines, at, line.indent);
  return line.indent > indent ? mapping(lines, at, line.indent, false) : ["", at];
}

/** A list of YAML, whose items are values, lists or mappings. */
function list(lines: Line[], begin: number, indent: number): Block<unknown[]> {
  const values: unknown[] = [];
  let at = begin;
  for (let line = lines[at]; line !== undefined && isItem(line) && line.indent === indent; line = lines[at]) {
    const item = { indent: indent + 2, line: line.line.slice(1).trim() };
    const isBlock = isItem(item) || /^["']?[A-Za-z_][\w. -]*["']?:(\s|$)/.test(item.line);
    if (!isBlock) values.push(scalar(item.line));
    lines[at] = item;
    const [value, next] = isBlock ? block(lines, at, indent + 1) : [undefined, at + 1];
    if (isBlock) values.push(value);
    // An item that cannot be read would never end.
    if (next === at) break;
    at = next;
  }
  return [values, at];
}

/** A tag, such as OpenCV's, stands before a block. */
const isTag = (text: string) => /^!!?[\w:-]+$/.test(text);

/** Sizes of images by the names of ZED's resolutions. */
const zedSizes: Record<string, readonly [number, number]> = {
  ...{ "4K": [3840, 2160], "2K": [2208, 1242], FHD: [1920, 1080], FHD1200: [1920, 1200], HD: [1280, 720] },
  ...{ HD1200: [1920, 1200], SVGA: [960, 600], VGA: [672, 376] },
};

/** Cameras of a pair: Middlebury's disparities are those of the first, ZED's sections of several sizes are named by these. */
function ofStereo(content: Content | undefined): Content | undefined {
  if (content === undefined) return undefined;
  const { cam1: _, ...first } = content;
  if ("cam0" in content && "doffs" in content) return first;
  const sections = Object.entries(content).filter(([name, value]) => name.startsWith("LEFT_CAM_") && isRecord(value));
  if (sections.length < 2) return content;
  const sized = ([name, value]: [string, unknown]) => {
    const resolution = zedSizes[name.replace(/^(LEFT|RIGHT)_CAM_/, "")];
    return [name, isRecord(value) && resolution !== undefined ? { resolution, ...value } : value];
  };
  return Object.fromEntries(Object.entries(content).map(sized));
}

/** Lines with their indentation, those of an open bracket joined, up to the end of the first document of YAML. */
function linesOf(text: string): Line[] {
  const lines: Line[] = [];
  let joined: string[] = [];
  let [indent, open] = [0, 0];
  for (const raw of text.split(/\r?\n/)) {
    if (/^(---|\.\.\.)/.test(raw) && lines.length > 0) break;
    const line = raw.trim().replace(/\s+/g, " ");
    if (line === "" || raw.startsWith("---") || line.startsWith(";")) continue;
    if (joined.length === 0) indent = raw.search(/\S/);
    joined.push(line);
    open += (line.match(/[[{(]/g)?.length ?? 0) - (line.match(/[\]})]/g)?.length ?? 0);
    if (open > 0) continue;
    const whole = joined.join(" ");
    // Several pairs in a line, unless they are in brackets.
    const parts =
      whole.includes("{") || whole.length > MAX_LINE
        ? [whole]
        : whole.split(/[,;]? (?=[A-Za-z_][\w.]* ?[:=] ?[^ :=])(?![^[]*\])/);
    lines.push(...parts.filter((part) => part.trim() !== "").map((part) => ({ indent, line: part.trim() })));
    [joined, open] = [[], 0];
  }
  return lines;
}
