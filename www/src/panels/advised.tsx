/** What is said of a result: the cause of what is wrong first, with what helps; warnings and contact among the rest. */
import { type Advice, adviceFor } from "../run/advice.js";
import { applyAlternative } from "../run/alternatives.js";
import type { ObjectModel } from "../state/object-model.js";
import type { Scene } from "../state/scene.js";
import { small, type Unit } from "../ui/format.js";
import { useWorkspace } from "../ui/workspace.js";
import { warningsOf } from "./sureness.js";

interface OfObject {
  object: ObjectModel | null;
}

const adviceIn = (scene: Scene | null, object: ObjectModel | null): Advice | null =>
  scene === null || object === null ? null : adviceFor(scene, object);

export function Advised({ object }: OfObject) {
  const workspace = useWorkspace();
  const { fileActions, isReadonly, scene } = workspace;
  const advice = adviceIn(scene.value, object);
  if (advice === null || object === null) return null;
  const { cause, text, remedy } = advice;
  const files = fileActions.value;
  const act = remedy?.act === "files" ? files?.edit : () => applyAlternative(workspace, object, -1);
  return (
    <p class="advice" role="status" data-cause={cause}>
      {text}{" "}
      {remedy !== null && act !== undefined && !isReadonly.value && (
        <button type="button" onClick={act}>
          {remedy.title}
        </button>
      )}
    </p>
  );
}

export function Warnings({ object }: OfObject) {
  const { scene, unit } = useWorkspace();
  const contact = object === null ? null : contactText(scene.value, object, unit.value);
  // The advice names the cause of a mesh that seems to be another one.
  const isTold = adviceIn(scene.value, object) !== null;
  const own = object === null ? [] : warningsOf(object).filter(({ code }) => !isTold || code !== "MESH_DOUBTFUL");
  const warnings = [...(scene.value?.warnings ?? []), ...own.map(({ message }) => message)];
  return (
    <>
      {contact !== null && <p class="quiet contact">{contact}</p>}
      {warnings.length > 0 && (
        <ul class="warnings">
          {warnings.map((warning) => (
            <li key={warning}>{warning}</li>
          ))}
        </ul>
      )}
    </>
  );
}

/** What the object rests on, if the alignment of the scene says so. */
function contactText(whole: Scene | null, object: ObjectModel, unit: Unit): string | null {
  const contact = object.alignment.value?.contact;
  if (contact === undefined || object.pose.value.source !== "aligned") return null;
  const { restsOn, gapM } = contact;
  if (restsOn === null) return "Touches nothing: it hangs, leans or floats.";
  const what =
    restsOn === "support"
      ? "the ground"
      : restsOn === "level"
        ? "a level above the ground"
        : (whole?.objects[restsOn]?.name ?? "another object");
  const gap = gapM === null ? "" : `, ${small(Math.abs(gapM), unit)} ${gapM < 0 ? "sunk in" : "above it"}`;
  return `Stands on ${what}${gap}.`;
}
