/** Pictures and posed meshes of cases, and their report. */
import { join } from "node:path";
import { exportGlb } from "../conventions/glb.js";
import type { UprightOptions } from "../conventions/upright.js";
import type { AlignInput } from "../index.js";
import { drawCase, drawOverlay } from "../pictures/case-pictures.js";
import { Shot } from "../pictures/shot.js";
import type { InputInfo } from "../types/results.js";
import { withoutUndefined } from "../values/validation.js";
import { type Entry, posesIn } from "./entry.js";
import { correctedInput, type ExportedAs, exportedMesh } from "./exports.js";
import { isFile } from "./files.js";
import type { Flags } from "./flags.js";
import { OutputError } from "./output-file.js";
import type { CaseKey } from "./record.js";
import { fileName, ReportFolder } from "./report.js";
import { isExport, type OutputName, type RunFiles } from "./run-files.js";

/** The picture and the posed mesh of a pose. */
const filesOfPose = ({ overlay, glb }: Flags, name: string) => ({
  overlay:
    overlay === undefined
      ? undefined
      : { flag: "--overlay", path: join(overlay, `${fileName(name)}.png`), isOwn: isExport },
  glb: glb === undefined ? undefined : { flag: "--glb", path: join(glb, `${fileName(name)}.glb`), isOwn: isExport },
});

/** The pictures and posed meshes of cases with one pose. Those of frames and objects have names that are not known yet. */
export const pictureFiles = (flags: Flags, cases: readonly CaseKey[]): OutputName[] =>
  cases.flatMap(({ name }) => Object.values(filesOfPose(flags, name)).filter((file) => file !== undefined));

/** Writes the pictures that the flags ask for, into folders that are there. */
export class Pictures {
  private constructor(
    private readonly flags: Flags,
    private readonly report: ReportFolder | undefined,
    private readonly files: RunFiles,
  ) {}

  /** @throws {@link UsageError} if the folder of the report has other content */
  static open(flags: Flags, files: RunFiles): Pictures {
    const { report } = flags;
    return new Pictures(flags, report === undefined ? undefined : ReportFolder.open(report, files), files);
  }

  /** Whether all files of a pose are there. */
  #has(name: string): boolean {
    const { overlay, glb } = filesOfPose(this.flags, name);
    return (this.report?.has(name) ?? true) && [overlay, glb].every((file) => file === undefined || isFile(file.path));
  }

  /**
   * Draws the poses in an entry.
   * @param isResumed whether pictures may be there already
   * @param inputsOf reads what the poses were found in, by their names
   * @throws {@link OutputError} if a file cannot be made
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
    const missing = poses.filter((pose) => !isResumed || !this.#has(pose.name));
    if (missing.length === 0) return;
    try {
      const inputs = await inputsOf();
      for (const pose of missing) await this.#drawPose(pose.name, pose.entry, inputs.get(pose.name));
    } catch (error) {
      throw error instanceof OutputError ? error : new OutputError(`no pictures: ${(error as Error).message}`);
    }
  }

  async #drawPose(name: string, entry: Entry, input: AlignInput | undefined): Promise<void> {
    if (input === undefined || !Array.isArray(entry.matrix)) return;
    const matrix = entry.matrix as number[];
    const { overlay, glb } = filesOfPose(this.flags, name);
    const shot = await Shot.of(await correctedInput(input, entry.depthCalibration as InputInfo["depthCalibration"]));
    try {
      if (this.report !== undefined) this.report.write(name, await drawCase(shot, matrix));
      if (overlay !== undefined) this.files.write(overlay, await drawOverlay(shot, matrix));
      if (glb !== undefined) this.files.write(glb, await posed(input, entry, this.flags.upright));
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
  return exportGlb(placed.mesh, placed.transform);
}
