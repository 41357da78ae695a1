/** The decision about a result: accept it, fix it, go on to the next one. */
import { accept, acceptSure, decideOn, fix, next, sureOf } from "../commands/decisions.js";
import { Menu, TextField } from "../ui/controls.js";
import { percent } from "../ui/texts.js";
import { useWorkspace } from "../ui/workspace.js";

export function Decision() {
  const workspace = useWorkspace();
  const { fileActions, list, rename, scene, selected } = workspace;
  const object = selected.value?.isPlaced ? selected.value : null;
  const correct = () => object !== null && fileActions.peek()?.correct(scene.peek()?.objects.indexOf(object) ?? 0);
  const verdict = object?.verdict.value ?? null;
  const hasNext = (scene.value?.objects.length ?? 0) > 1 || list.value.length > 1;
  return (
    <fieldset class="row decision" part="decision" disabled={object === null}>
      <legend class="visually-hidden">Decision</legend>
      <button
        type="button"
        id="accept"
        aria-pressed={verdict === "accepted"}
        aria-keyshortcuts="Enter"
        onClick={() => accept(workspace)}
      >
        {verdict === "accepted" ? "✓ Accepted" : "Accept"}
      </button>
      <button type="button" id="fix" onClick={(event) => fix(workspace, event)}>
        Fix
      </button>
      {fileActions.value !== null && (
        <button type="button" id="correct-mask" title="Correct the mask" onClick={correct}>
          Mask …
        </button>
      )}
      <button type="button" id="next" disabled={!hasNext} aria-keyshortcuts="N" onClick={() => next(workspace)}>
        Next
      </button>
      <Menu title="⋯" isIcon label="More decisions">
        {(["skipped", "impossible"] as const).map((one) => (
          <button
            key={one}
            type="button"
            id={one}
            aria-pressed={verdict === one}
            aria-keyshortcuts={one === "skipped" ? "X" : "I"}
            onClick={() => decideOn(one)(workspace)}
          >
            {one === "skipped" ? "Skip" : "Impossible"}
          </button>
        ))}
        <TextField
          id="object-name"
          title="Name"
          value={object?.name ?? ""}
          onEnter={(text) => object !== null && rename(object, text.trim() || object.name)}
        />
        <TextField
          id="comment"
          title="Comment"
          value={object?.comment.value ?? ""}
          onEnter={(text) => {
            if (object !== null) object.comment.value = text;
          }}
        />
      </Menu>
    </fieldset>
  );
}

/** Confidences from which on all objects may be accepted together. */
const thresholds = [0.9, 0.95, 0.99] as const;

/** Accepts all objects of a scene that are sure, at once. */
export function AcceptSure() {
  const workspace = useWorkspace();
  const counts = thresholds.map((least) => [least, sureOf(workspace.objects.value, least).length] as const);
  if (counts[0]?.[1] === 0) return null;
  return (
    <Menu title="Accept all" label="Accept all that are sure">
      {counts.map(([least, count]) => (
        <button key={least} type="button" disabled={count === 0} onClick={() => acceptSure(workspace, least)}>
          {percent(least)} or more: {count}
        </button>
      ))}
    </Menu>
  );
}
