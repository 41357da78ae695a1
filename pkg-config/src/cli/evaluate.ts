/** `sim3align evaluate`: computes the metrics of transforms on cases. */

import { OPTIONS, type OptionRow } from "../index.js";
import { failure } from "../values/error.js";
import { evaluationColumns, viewsOf } from "./align.js";
import { failedLines, type Job } from "./batch.js";
import { evaluationDetails } from "./details.js";
import { type Entry, failureEntry, isFailure, posesIn, withFiles } from "./entry.js";
import { caseSettings, type Flags } from "./flags.js";
import { caseKind, type FolderToDo, foldersToDo } from "./folders.js";
import { optionValues } from "./option-flags.js";
import { caseTable } from "./table.js";
import { readTransform } from "./transform-file.js";

// The true pose and the symmetry come from the case.
export const evaluateOptions: readonly OptionRow[] = OPTIONS.evaluate.filter(
  ({ name }) => name !== "truth" && name !== "symmetry",
);

/** The job of a command line: the metrics of each case, or of each of its frames with a mask. */
export async function evaluateJob(args: readonly string[], flags: Flags): Promise<Job<FolderToDo>> {
  const tasks = await foldersToDo(caseKind, args, flags.list);
  const { transform = "gt" } = flags;
  const options = optionValues(flags, evaluateOptions);
  const row = caseTable(
    tasks.map(({ name }) => name),
    evaluationColumns,
  );
  return {
    tasks,
    folders: tasks.map(({ folder }) => folder),
    async run(aligner, { name, path, folder }) {
      const frames = new Map<string, Entry>();
      for (const { frame, input, truth, found } of await viewsOf(folder, caseSettings(flags))) {
        const evaluate = async (): Promise<Entry> => {
          const target = truth === null ? {} : { truth: truth.transform, symmetry: truth.symmetry };
          if (transform === "gt" && truth === null) throw noTruth(frame === undefined ? folder : `${folder}/${frame}`);
          const matrix =
            transform === "gt"
              ? truth?.transform.matrix
              : await readTransform("transform", transform, { name, path }, input.mesh, frame);
          const evaluation = await aligner.evaluate(input, { matrix: matrix ?? [] }, { ...options, ...target });
          return withFiles({ ...evaluation }, found);
        };
        const entry = await evaluate().catch((error) => failureEntry(error, found));
        if (frame === undefined) return entry;
        frames.set(frame, entry);
      }
      return { frames: Object.fromEntries(frames) };
    },
    lines(task, entry, isOnly, style) {
      const poses = posesIn(task.name, entry);
      return {
        rows: isOnly ? [] : poses.flatMap((pose) => row(pose.name, pose.entry, style)),
        remarks: poses.flatMap((pose) => {
          if (isFailure(pose.entry)) return failedLines(pose.name, pose.entry, style);
          return isOnly ? evaluationDetails(pose.name, pose.entry, style) : [];
        }),
      };
    },
  };
}

function noTruth(folder: string) {
  const found = `no true pose in ${folder}`;
  return failure("FILE_NOT_FOUND", "transform", found, "gt.json with a pose", "Pass --transform FILE.");
}
