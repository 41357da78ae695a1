/** The files of a run: no output is an input or another output. */
import { existsSync, readFileSync } from "node:fs";
import { basename, dirname, join, sep } from "node:path";
import { partOf } from "../case-names.js";
import { refersToFiles } from "../input/formats.js";
import {
  bytesOf,
  identityOf,
  isFile,
  isOrdinary,
  namesIn,
  partsOf,
  placesOf,
  realPath,
  statOf,
  UsageError,
} from "./files.js";
import { checkWritable, makeFolder, OutputError, OutputFile } from "./output-file.js";

/** A file or folder that a command line names. */
export interface NamedFile {
  /** The flag, or what an argument is called. */
  flag: string;
  path: string;
  isFolder?: boolean;
}

/** An input. In a folder, these are the files of a case or a scene, or, if it is deep, those at any depth. */
export interface InputFile extends NamedFile {
  isDeep?: boolean | undefined;
}

/** An output. */
export interface OutputName extends NamedFile {
  /** Whether a file that begins so is an output of the same flag, which may be replaced. Others are not. */
  isOwn?: ((beginning: string) => boolean) | undefined;
  /** Names in a folder, the last of which is written when all others are there. */
  holds?: readonly string[] | undefined;
}

/** Whether a file begins like one that this package exports: pictures, meshes and scenes name it. */
export const isExport = (beginning: string) => beginning.includes("sim3align");

/** Depth of the folders that are searched for inputs. */
const LEVELS = 5;

/** The files of a run. */
export class RunFiles {
  readonly #inputs: InputFile[] = [];
  /** The flags of named files, by the places where these are. */
  readonly #named = new Map<string, string>();
  readonly #outputs = new Map<string, string>();
  /** The folders that are read as a whole. */
  readonly #whole: string[] = [];
  readonly #written = new Set<string>();
  #scanned: { files: Map<string, string>; parts: Map<string, string>; models: string[] } | undefined;

  constructor(inputs: readonly InputFile[]) {
    this.add(inputs);
  }

  /** Adds inputs. */
  add(inputs: readonly InputFile[]): void {
    this.#inputs.push(...inputs);
    for (const { flag, path, isFolder, isDeep } of inputs) {
      if (isFolder && isDeep) this.#whole.push(realPath(path));
      if (!isFolder && path !== "-") for (const place of placesOf(path)) this.#named.set(place, flag);
    }
    this.#scanned = undefined;
  }

  /**
   * Checks outputs before anything is written.
   * @throws {@link UsageError} for one that is an input or another output, or that cannot be written
   */
  check(outputs: readonly OutputName[]): void {
    const folders = outputs.filter(({ isFolder }) => isFolder).map(({ path }) => `${realPath(path)}${sep}`);
    for (const output of outputs) {
      const { flag, path, isFolder, holds = [] } = output;
      if (isFolder) {
        if (statOf(path)?.isDirectory() === false)
          throw new UsageError(`${flag} ${path}: the folder cannot be made: it is a file.`);
        for (const name of [...holds, ...(holds.includes("meshes") ? simulated(path) : [])])
          this.#claim({ flag, path: join(path, name), isOwn: output.isOwn });
        continue;
      }
      this.#claim(output);
      // The folder of a file may be one that this run makes, or be made with one in it.
      const own = `${dirname(realPath(path))}${sep}`;
      const isMade = !existsSync(own) && folders.some((made) => own.startsWith(made) || made.startsWith(own));
      if (!isMade) checkWritable(flag, path);
    }
  }

  /**
   * Opens an output, which gets its content when it is closed.
   * @throws {@link OutputError} for a file that the run reads, or has written before
   */
  open(output: OutputName): OutputFile {
    try {
      this.#claim(output);
    } catch (error) {
      throw new OutputError((error as Error).message);
    }
    const { flag, path } = output;
    const ordinary = isOrdinary(path);
    if (ordinary && placesOf(path).some((place) => this.#written.has(place)))
      throw new OutputError(`${flag} ${path}: two files have this name. Rename one of the cases.`);
    return new OutputFile(path, false, () => {
      for (const place of ordinary ? placesOf(path) : []) {
        this.#written.add(place);
        this.#outputs.set(place, flag);
      }
    });
  }

  /** Writes an output, and first its folder. */
  write(output: OutputName, content: string | Uint8Array): void {
    const file = this.open(output);
    if (isOrdinary(output.path)) makeFolder(output.flag, dirname(output.path));
    file.write(content);
    file.end();
  }

  /** @throws {@link UsageError} if a file is an input or another output */
  #claim({ flag, path, isOwn }: OutputName): void {
    const places = placesOf(path);
    const [place = path, identity] = places;
    const isFolder = statOf(place)?.isDirectory() === true;
    if (path !== "-" && !isFolder && !isOrdinary(place)) return;
    const others = places.flatMap((each) => this.#named.get(each) ?? this.#outputs.get(each) ?? []);
    const other = others.find((found) => found !== flag);
    if (other !== undefined) throw new UsageError(`${other} and ${flag} name the same file: ${path}.`);
    for (const each of places) this.#outputs.set(each, flag);
    if (path === "-" || isFolder || this.#written.has(place)) return;
    const refuse = (input: string) => {
      throw new UsageError(`${flag} ${path}: this is a file of the input ${input}. Pass another name.`);
    };
    const part = partOf(basename(place)) && this.#scan().parts.get(dirname(place));
    if (part !== undefined) refuse(part);
    const checkOwn = () => {
      const beginning = identity === undefined ? "" : bytesOf(place, 0, 4096).toString("latin1");
      if (beginning === "" || isOwn === undefined || isOwn(beginning)) return;
      throw new UsageError(`${flag} ${path}: this file was not written by ${flag}. Remove it, or pass another name.`);
    };
    if (isOwn !== undefined && isOwn !== isExport) {
      checkOwn();
      return;
    }
    // The next run would read it.
    for (const folder of this.#whole) if (place.startsWith(`${folder}${sep}`)) refuse(folder);
    if (identity === undefined) return;
    const { files, models } = this.#scan();
    const input = files.get(identity) ?? models.find((model) => mentions(model, place));
    if (input !== undefined) refuse(input);
    checkOwn();
  }

  /**
   * The identities of the files that are read, with their inputs; the folders in which names are reserved; and the meshes
   * that refer to other files. Folders of a dataset may have a million files: they are looked for when that is needed.
   */
  #scan() {
    if (this.#scanned !== undefined) return this.#scanned;
    const [files, parts] = [new Map<string, string>(), new Map<string, string>()];
    const models: string[] = [];
    const add = (folder: string, input: string, levels: number) => {
      for (const name of namesIn(folder)) {
        const path = join(folder, name);
        const identity = identityOf(path);
        if (refersToFiles(name)) models.push(path);
        if (identity !== undefined && (levels > 1 || partOf(name) !== undefined)) files.set(identity, input);
        if (levels > 1 && statOf(path)?.isDirectory()) add(path, input, levels - 1);
      }
    };
    for (const { path, isFolder, isDeep } of this.#inputs) {
      if (!isFolder && refersToFiles(path)) add(dirname(path), path, 1);
      if (!isFolder) continue;
      for (const part of partsOf(path)) {
        parts.set(realPath(part), path);
        add(part, path, isDeep ? LEVELS : 1);
      }
    }
    this.#scanned = { files, parts, models };
    return this.#scanned;
  }
}

/** The files of a folder for simulators, whose names follow from the objects. */
const simulated = (folder: string) => [
  ...namesIn(folder).filter((name) => name.endsWith(".urdf")),
  ...namesIn(join(folder, "meshes")).flatMap((name) => (name.endsWith(".obj") ? [join("meshes", name)] : [])),
];

/** Whether a file has the name of another one in its text. */
function mentions(model: string, file: string): boolean {
  if (!file.startsWith(`${dirname(realPath(model))}${sep}`) || !isFile(model)) return false;
  const text = readFileSync(model);
  return [basename(file), encodeURIComponent(basename(file))].some((name) => text.includes(name));
}
