/** The flags that write pictures and posed meshes. */
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import type { Command } from "commander";
import { inputOfFrame, readFrames } from "../case-folder.js";
import { exportGlb, placeGlb } from "../conventions/glb.js";
import type { UprightOptions } from "../conventions/upright.js";
import type { AlignInput } from "../input/types.js";
import { drawCase, drawOverlay } from "../pictures/case-pictures.js";
import { Shot } from "../pictures/shot.js";
import type { InputInfo } from "../types/results.js";
import { isRecord, withoutUndefined } from "../values/values.js";
import { type CaseFlags, caseSettings } from "./case-options.js";
import type { CaseToDo } from "./cases.js";
import { correctedInput } from "./corrected-input.js";
import { type ExportedAs, exportedMesh } from "./exported-mesh.js";
import { alternativesOf, fileName, ReportFolder } from "./report-folder.js";
import { makeFolder } from "./writable.js";

/** Values of the flags. */
export interface PictureFlags {
  report?: string;
  overlay?: string;
  glb?: string;
  upright?: boolean;
}

/** A pose to be shown: its name, its JSON entry and, if it can be drawn, what it was found in. */
export interface Shown {
  name: string;
  entry: Readonly<Record<string, unknown>>;
  input?: AlignInput | undefined;
}

/** The poses in a JSON entry: one, or one for each of its frames or objects. */
export function shownIn(name: string, entry: object): Shown[] {
  const { frames, objects = frames, ...own } = entry as Readonly<Record<string, unknown>>;
  if (!isRecord(objects)) return [{ name, entry: own }];
  // The objects of a scene are in one depth map.
  const { depthCalibration, support } = own;
  return Object.entries(objects).map(([part, pose]) => ({
    name: `${name}/${part}`,
    entry: { ...withoutUndefined({ depthCalibration, support }), ...(pose as object) },
  }));
}

/** Adds the flags to a command. */
export const addPictureFlags = (command: Command): Command =>
  command
    .option("--report <folder>", "write a page with a table, pictures and a 3D view of each case")
    .option("--overlay <folder>", "write a PNG of each case: the image, the mask and the mesh")
    .option("--glb <folder>", "write the posed mesh of each case as a GLB file")
    .option("--upright", "give the meshes in exported files upright frames: up along the support, a tight box");

/** Writes what the flags ask for. */
export class Pictures {
  readonly #flags: PictureFlags;
  readonly #report: ReportFolder | undefined;

  private constructor(flags: PictureFlags, report: ReportFolder | undefined) {
    this.#flags = flags;
    this.#report = report;
  }

  /** @throws {@link UsageError} if a folder cannot be written */
  static async open(flags: PictureFlags): Promise<Pictures> {
    const { report, overlay, glb } = flags;
    if (overlay !== undefined) makeFolder("--overlay", overlay);
    if (glb !== undefined) makeFolder("--glb", glb);
    return new Pictures(flags, report === undefined ? undefined : await ReportFolder.open(report));
  }

  /** Whether an input has to be read for pictures. */
  get isWanted(): boolean {
    return this.#report !== undefined || this.#flags.overlay !== undefined || this.#flags.glb !== undefined;
  }

  /** Whether the pictures of the report are there. */
  has(name: string): boolean {
    return this.#report?.has(name) ?? true;
  }

  /** Writes the pictures of a pose. */
  async draw({ name, entry, input }: Shown): Promise<void> {
    if (!this.isWanted || input === undefined || !Array.isArray(entry.matrix)) return;
    const matrix = entry.matrix as number[];
    const { overlay, glb } = this.#flags;
    const shot = await Shot.of(await correctedInput(input, entry.depthCalibration as InputInfo["depthCalibration"]));
    try {
      if (this.#report !== undefined) {
        const others = alternativesOf(entry).map((other) => other.matrix as number[]);
        await this.#report.write(name, entry, await drawCase(shot, matrix, others));
      }
      if (overlay !== undefined)
        await writeFile(join(overlay, `${fileName(name)}.png`), await drawOverlay(shot, matrix));
      if (glb !== undefined)
        await writeFile(join(glb, `${fileName(name)}.glb`), await posed(input, entry, this.#flags.upright));
    } finally {
      await shot.dispose();
    }
  }

  /** Adds a row to the report. */
  record(name: string, entry: Readonly<Record<string, unknown>>): void {
    this.#report?.add(name, entry);
  }

  end(): void {
    this.#report?.end();
  }
}

/** What is read of an entry of a posed mesh. */
interface PosedEntry extends Partial<ExportedAs>, Pick<UprightOptions, "support"> {
  matrix: number[];
}

/** The posed mesh, in the proportions that were found: a GLB keeps its materials. */
async function posed({ mesh }: AlignInput, entry: Shown["entry"], isUpright = false): Promise<Uint8Array> {
  const { matrix, proportions, support } = entry as unknown as PosedEntry;
  const upright = isUpright ? withoutUndefined({ support }) : undefined;
  const placed = await exportedMesh(mesh, { matrix }, { proportions, upright });
  return placed.mesh instanceof Uint8Array
    ? placeGlb(placed.mesh, placed.transform)
    : exportGlb(placed.mesh, placed.transform);
}

/**
 * Draws the poses in an entry. What cannot be drawn is said, and changes no result.
 * @param isResumed whether pictures may be there already
 * @param inputsOf reads what the poses were found in, by the names that {@link shownIn} gives them
 */
export async function drawEntry(
  pictures: Pictures,
  name: string,
  entry: object,
  isResumed: boolean,
  inputsOf: () => Promise<ReadonlyMap<string, AlignInput>>,
): Promise<void> {
  if (!pictures.isWanted || "error" in entry) return;
  const shown = shownIn(name, entry);
  if (isResumed && shown.every((each) => pictures.has(each.name))) return;
  try {
    const inputs = await inputsOf();
    for (const each of shown) await pictures.draw({ ...each, input: inputs.get(each.name) });
  } catch (error) {
    console.error(`no pictures of ${name}: ${(error as Error).message}`);
  }
}

/** What the poses of a case were found in. */
export async function inputsOfCase(
  { name, folder, read }: CaseToDo,
  entry: object,
  flags: CaseFlags,
): Promise<Map<string, AlignInput>> {
  if (!("frames" in entry) || folder === undefined) return new Map([[name, (await read()).input]]);
  const { mesh, frames } = await readFrames(folder, caseSettings(flags));
  const inputs = new Map<string, AlignInput>();
  for (const frame of frames) {
    const input = inputOfFrame(frame, mesh);
    if (input !== undefined) inputs.set(`${name}/${frame.name}`, input);
  }
  return inputs;
}
