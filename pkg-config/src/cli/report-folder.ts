/** A report: a page, its rows, and a folder of pictures for each case. */
import { createHash } from "node:crypto";
import { existsSync, readdirSync } from "node:fs";
import { mkdir, rename, writeFile } from "node:fs/promises";
import { basename, join, resolve } from "node:path";
import type { CasePictures } from "../pictures/case-pictures.js";
import type { ReportDetails, ReportRow } from "../report-page/types.js";
import { isRecord } from "../values/values.js";
import { isMetric } from "./lengths.js";
import { LineFile } from "./line-file.js";
import { reportHtml } from "./report-html.js";
import { UsageError } from "./usage-error.js";
import { makeFolder } from "./writable.js";

type Entry = Readonly<Record<string, unknown>>;

/** The files of a report, which is complete after each case. */
export class ReportFolder {
  readonly #folder: string;
  readonly #rows: LineFile;

  private constructor(folder: string) {
    this.#folder = folder;
    this.#rows = new LineFile(join(folder, "rows.js"), "w");
  }

  /**
   * Writes a page without rows. A report that is there gets new rows.
   * @throws {@link UsageError} if the folder cannot be written, or has other content
   */
  static async open(folder: string): Promise<ReportFolder> {
    makeFolder("--report", folder);
    if (readdirSync(folder).length > 0 && !existsSync(join(folder, "rows.js"))) {
      throw new UsageError(`--report ${folder}: the folder has other content. Pass a new folder.`);
    }
    const report = new ReportFolder(folder);
    await writeFile(join(folder, "index.html"), await reportHtml(basename(resolve(folder))));
    report.#rows.append(['"use strict";']);
    return report;
  }

  /** Whether the pictures of a case are there. */
  has(name: string): boolean {
    return existsSync(join(this.#folder, "cases", fileName(name), "details.js"));
  }

  /** Adds a row to the table; its pictures are shown if they are there. */
  add(name: string, entry: Entry): void {
    const row: ReportRow = rowOf(name, entry, this.has(name) ? fileName(name) : undefined);
    this.#rows.append([`sim3align.rows.push(${JSON.stringify(row)});`]);
  }

  /** Writes the pictures of a case: `details.js` last, so that its presence tells that all are there. */
  async write(name: string, entry: Entry, { files, limitMm, isPhoto, space }: CasePictures): Promise<void> {
    const folder = join(this.#folder, "cases", fileName(name));
    await mkdir(folder, { recursive: true });
    await Promise.all(Object.entries(files).map(([file, bytes]) => writeFile(join(folder, file), bytes)));
    const alternatives = alternativesOf(entry).map(({ turnDeg, score }, k) => ({
      file: `alternative-${k + 1}.png`,
      turnDeg: Number(turnDeg),
      score: Number(score),
    }));
    const matrix = entry.matrix as number[];
    const details: ReportDetails = { limitMm, isPhoto, alternatives, matrix, space };
    const text = `sim3align.details[${JSON.stringify(fileName(name))}] = ${JSON.stringify(details)};\n`;
    await writeFile(join(folder, "details.part"), text);
    await rename(join(folder, "details.part"), join(folder, "details.js"));
  }

  end(): void {
    this.#rows.end();
  }
}

/** The name of the files of a case: its own, if all file systems can have it, otherwise with a checksum. */
export function fileName(name: string): string {
  if (/^[a-z0-9][a-z0-9._-]{0,80}$/.test(name)) return name;
  const check = createHash("sha256").update(name).digest("hex").slice(0, 8);
  return `${name
    .replace(/[^A-Za-z0-9._-]+/g, "-")
    .replace(/^[.-]+/, "")
    .slice(-80)}-${check}`;
}

/** The alternatives of an entry. */
export const alternativesOf = ({ alternatives }: Entry): Entry[] =>
  Array.isArray(alternatives) ? alternatives.filter(isRecord) : [];

/** The row of a JSON entry. */
function rowOf(name: string, entry: Entry, folder: string | undefined): ReportRow {
  const part = (key: string): Entry => (isRecord(entry[key]) ? (entry[key] as Entry) : {});
  const number = (value: unknown) => (typeof value === "number" ? value : null);
  const [metrics, errors, error] = [part("metrics"), part("errors"), part("error")];
  const messages = (value: unknown) => (Array.isArray(value) ? value : []).filter(isRecord);
  return {
    name,
    ...(folder === undefined ? {} : { folder }),
    ...("error" in entry ? { error: { code: String(error.code), message: String(error.message) } } : {}),
    confidence: number(entry.confidence),
    isMetric: isMetric(entry),
    scale: number(entry.scale),
    alternatives: alternativesOf(entry).length,
    iou: number(metrics.iou),
    boundaryF: number(metrics.boundaryF),
    chamferMm: number(metrics.chamferMm),
    depthMaeMm: number(metrics.depthMaeMm),
    ...("errors" in entry
      ? {
          errors: {
            scale: Number(errors.scaleError),
            rotationDeg: Number(errors.rotationErrorDeg),
            translation: Number(errors.translationErrorRelative),
          },
        }
      : {}),
    warnings: messages(entry.warnings).map(({ code, message }) => ({ code: String(code), message: String(message) })),
    timeMs: number(part("timingsMs").total),
  };
}
