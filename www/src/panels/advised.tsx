/** What is said of a result: the cause of what is wrong first, with what helps; warnings and contact among the rest. */
import { type Advice, adviceFor } from "../alignment/advice.js";
import type { ObjectModel } from "../state/object-model.js";
import { SURE } from "../state/progress.js";
import type { Scene } from "../state/scene.js";
import { useWorkspace } from "../ui/workspace.js";

interface OfObject {
  object: ObjectModel | null;
}

const adviceIn = (scene: Scene | null, object: ObjectModel | null): Advice | null =>
  scene === null || object === null ? null : adviceFor(scene, object);

export function Advised({ object }: OfObject) {
  const workspace = useWorkspace();
  const { fileActions, isReadonly, isRunning } = workspace;
  const isBusy = isRunning.value;
  const advice = adviceIn(workspace.scene.value, object);
  if (advice === null || object === null) return null;
  const { cause, text, remedies } = advice;
  const hasFiles = fileActions.value !== null;
  const offered = isReadonly.value ? [] : remedies.filter(({ needsFiles }) => hasFiles || !needsFiles);
  return (
    <div class="stack note advice" role="status" data-cause={cause}>
      <p>{text}</p>
      {offered.length > 0 && (
        <p class="row">
          {offered.map(({ title, act }) => (
            <button key={title} type="button" disabled={isBusy} onClick={() => act(workspace, object)}>
              {title}
            </button>
          ))}
        </p>
      )}
    </div>
  );
}

export function Warnings({ object }: OfObject) {
  const { scene } = useWorkspace();
  const contact = object === null ? null : contactText(scene.value, object);
  const told: readonly string[] = adviceIn(scene.value, object)?.codes ?? [];
  const own = object === null ? [] : warningsOf(object).filter(({ code }) => !told.includes(code));
  const warnings = [...(scene.value?.warnings ?? []), ...own.map(({ message }) => message)];
  return (
    <>
      {contact !== null && <p class="quiet contact">{contact}</p>}
      {warnings.length > 0 && (
        <ul class="stack warnings">
          {warnings.map((warning) => (
            <li key={warning}>{warning}</li>
          ))}
        </ul>
      )}
    </>
  );
}

/** Of a mesh that a generator has made, the underside is a guess. Gaps above this share of the size are no contact. */
const TOUCHING = 0.03;

/** What the object rests on, if that is sure. */
function contactText(whole: Scene | null, object: ObjectModel): string | null {
  const { box, confidence, pose } = object;
  const { restsOn = null, gapM } = object.alignment.value?.contact ?? {};
  const isSure = pose.value.source === "aligned" && (confidence ?? 0) >= SURE;
  if (restsOn === null || !isSure || Math.abs(gapM ?? 1) > TOUCHING * Math.max(...box.value.sizeM)) return null;
  if (restsOn === "support") return "Stands on the ground.";
  if (restsOn === "level") return "Stands on a level above the ground.";
  return `Stands on ${whole?.objects[restsOn]?.name ?? "another object"}.`;
}

/** A refinement that could go on concerns nobody whose result is sure. */
const isQuiet = (code: string, object: ObjectModel) =>
  code === "NOT_CONVERGED" && (object.precise?.confidence ?? 0) >= SURE;

const all = ({ alignment }: ObjectModel) => alignment.value?.warnings ?? [];

/** The warnings beside the result. */
export const warningsOf = (object: ObjectModel) => all(object).filter(({ code }) => !isQuiet(code, object));

/** The warnings among the details. */
export const quietWarningsOf = (object: ObjectModel) => all(object).filter(({ code }) => isQuiet(code, object));
