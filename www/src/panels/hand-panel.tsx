/** Adjusting the pose by hand: undo and redo; while something is fixed, handles, refine, numbers and steps. */
import { refine } from "../alignment/align.js";
import { canNudge, nudgeGroups } from "../commands/nudges.js";
import { Check } from "../ui/controls.js";
import { useWorkspace } from "../ui/workspace.js";
import { KnownSize } from "./known-size.js";
import { Numbers } from "./numbers.js";

const modes = [
  ["translate", "Move", "G"],
  ["rotate", "Rotate", "R"],
  ["scale", "Scale", "S"],
] as const;

const settings = [
  ["snap", "snaps", "Snap"],
  ["local-axes", "isLocal", "Axes of the mesh"],
] as const;

const steps = [
  ["undo", "Undo", "Control+Z", "canUndo"],
  ["redo", "Redo", "Control+Shift+Z", "canRedo"],
] as const;

export function HandPanel() {
  const workspace = useWorkspace();
  const { gizmo, gizmoSettings, isRunning, nudge, selected, space, unit } = workspace;
  const object = selected.value;
  const lockScale = object !== null && object.knownScale.value !== null;
  const isReady = object !== null && !isRunning.value && !object.isLocked.value;
  const isMetric = unit.value === null;
  const size = <KnownSize object={object} id="known-size" />;
  return (
    <section class="panel hand-panel" style={{ gridArea: "hand" }} part="hand" aria-labelledby="hand-title">
      {/* Each is in sight while it can do something, or has the focus. */}
      <div class="row">
        {steps.map(([name, title, keys, can]) => (
          <button
            key={name}
            type="button"
            id={name}
            class="step"
            aria-disabled={!workspace[can].value}
            aria-keyshortcuts={keys}
            onClick={workspace[name]}
          >
            {title}
          </button>
        ))}
      </div>
      {/* Without it, no size of the scene has a unit. */}
      {!isMetric && size}
      <details class="more" open={gizmo.value !== null}>
        <summary id="hand-title">By hand</summary>
        <fieldset class="handles" disabled={!isReady || space.value.kind !== "ready"}>
          <legend>Handles in 3D, and arrow keys</legend>
          {modes.map(([mode, title, key]) => (
            <button
              key={mode}
              type="button"
              aria-pressed={gizmo.value === mode}
              aria-keyshortcuts={key}
              disabled={mode === "scale" && lockScale}
              onClick={() => {
                gizmo.value = gizmo.peek() === mode ? null : mode;
              }}
            >
              {title}
            </button>
          ))}
        </fieldset>
        {/* A disabled button would lose the focus while it runs. */}
        <button
          type="button"
          id="refine"
          aria-disabled={!isReady}
          aria-keyshortcuts="F"
          onClick={() => refine(workspace)}
        >
          Refine pose
        </button>
        {isMetric && size}
        <div class="row">
          <Check
            id="lock-scale"
            title="Lock scale"
            checked={lockScale}
            disabled={object === null || !isMetric}
            onCheck={(checked) => object?.lockScale(checked)}
          />
          {settings.map(([id, name, title]) => (
            <Check
              key={id}
              id={id}
              title={title}
              checked={gizmoSettings.value[name]}
              onCheck={(checked) => {
                gizmoSettings.value = { ...gizmoSettings.peek(), [name]: checked };
              }}
            />
          ))}
        </div>
        <Numbers object={object} isReady={isReady} />
        {nudgeGroups.map((group) => (
          <fieldset key={group.mode} class="steps" disabled={object === null || !canNudge(workspace, object, group)}>
            <legend>{group.legend}</legend>
            {group.nudges.map(([title, symbol, change]) => (
              <button
                key={title}
                type="button"
                aria-label={group.verb + title}
                title={group.verb && title}
                onClick={() => object !== null && nudge(object, change(object))}
              >
                {symbol}
              </button>
            ))}
          </fieldset>
        ))}
      </details>
    </section>
  );
}
