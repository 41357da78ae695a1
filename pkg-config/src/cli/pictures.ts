/** Pictures and posed meshes of cases, and their report. */
import { writeFile } from "node:fs/promises";
import { join } from "node:path";
import { exportGlb, placeGlb } from "../conventions/glb.js";
import type { UprightOptions } from "../conventions/upright.js";
import type { AlignInput, InputInfo } from "../index.js";
import { drawCase, drawOverlay } from "../pictures/case-pictures.js";
import { Shot } from "../pictures/shot.js";
import { withoutUndefined } from "../values/values.js";
import { alternativesOf, type Entry, posesIn } from "./entry.js";
import { correctedInput, type ExportedAs, exportedMesh } from "./exports.js";
import type { Flags } from "./flags.js";
import { fileName, ReportFolder } from "./report.js";

/** Writes the pictures that the flags ask for, into folders that are there. */
export class Pictures {
  private constructor(
    private readonly flags: Flags,
    private readonly report: ReportFolder | undefined,
  ) {}

  /** @throws {@link UsageError} if the folder of the report has other content */
  static async open(flags: Flags): Promise<Pictures> {
    return new Pictures(flags, flags.report === undefined ? undefined : await ReportFolder.open(flags.report));
  }

  /**
   * Draws the poses in an entry. What cannot be drawn is said, and changes no result.
   * @param isResumed whether pictures may be there already
   * @param inputsOf reads what the poses were found in, by their names
   */
  async draw(
    name: string,
    entry: Entry,
    isResumed: boolean,
    inputsOf: () => Promise<ReadonlyMap<string, AlignInput>>,
  ): Promise<void> {
    const { report, flags } = this;
    if ((report ?? flags.overlay ?? flags.glb) === undefined || "error" in entry) return;
    const poses = posesIn(name, entry);
    if (isResumed && poses.every((pose) => report?.has(pose.name) ?? true)) return;
    try {
      const inputs = await inputsOf();
      for (const pose of poses) await this.#drawPose(pose.name, pose.entry, inputs.get(pose.name));
    } catch (error) {
      console.error(`no pictures of ${name}: ${(error as Error).message}`);
    }
  }

  async #drawPose(name: string, entry: Entry, input: AlignInput | undefined): Promise<void> {
    if (input === undefined || !Array.isArray(entry.matrix)) return;
    const matrix = entry.matrix as number[];
    const { overlay, glb, upright } = this.flags;
    const shot = await Shot.of(await correctedInput(input, entry.depthCalibration as InputInfo["depthCalibration"]));
    const file = (folder: string, ending: string) => join(folder, `${fileName(name)}.${ending}`);
    try {
      const others = alternativesOf(entry).map((other) => other.matrix as number[]);
      if (this.report !== undefined) await this.report.write(name, entry, await drawCase(shot, matrix, others));
      if (overlay !== undefined) await writeFile(file(overlay, "png"), await drawOverlay(shot, matrix));
      if (glb !== undefined) await writeFile(file(glb, "glb"), await posed(input, entry, upright));
    } finally {
      await shot.dispose();
    }
  }

  /** Adds the rows of an entry to the report. */
  record(name: string, entry: Entry): void {
    for (const pose of this.report === undefined ? [] : posesIn(name, entry)) this.report?.add(pose.name, pose.entry);
  }

  end(): void {
    this.report?.end();
  }
}

/** The properties of an entry that a posed mesh needs. */
interface PosedEntry extends Partial<ExportedAs>, Pick<UprightOptions, "support"> {
  matrix: number[];
}

/** The posed mesh, in the proportions that were found: a GLB keeps its materials. */
async function posed({ mesh }: AlignInput, entry: Entry, isUpright = false): Promise<Uint8Array> {
  const { matrix, proportions, support } = entry as unknown as PosedEntry;
  const upright = isUpright ? withoutUndefined({ support }) : undefined;
  const placed = await exportedMesh(mesh, { matrix }, { proportions, upright });
  return placed.mesh instanceof Uint8Array
    ? placeGlb(placed.mesh, placed.transform)
    : exportGlb(placed.mesh, placed.transform);
}
