/** The intake sheet: what each file of a draft is used for, what is missing, and what helps. */
import { useEffect, useMemo, useRef } from "preact/hooks";
import { type Draft, draft, draftInputs, isReady } from "../input/draft.js";
import { baseName } from "../input/files.js";
import { canBeVideo } from "../input/video-frames.js";
import { depthImage } from "../pictures/colours.js";
import type { Inputs, Role } from "../state/inputs.js";
import { page } from "../state/page.js";
import { Check, Choices, FileButton } from "../ui/controls.js";
import { CameraCard, DepthCard, PhotoCard } from "./cards.js";
import { accept, assign, asVideo, change, dismiss, label, look, putIntoShown } from "./draft.js";
import { propose } from "./drop.js";
import { isUnassigned } from "./file-roles.js";
import { Marking } from "./marking.js";
import { ObjectRows } from "./object-rows.js";
import { Problems } from "./problem-list.js";

export function Sheet() {
  const dialog = useRef<HTMLDialogElement>(null);
  const open = draft.value;
  useEffect(() => {
    if (dialog.current?.open === false) dialog.current.showModal();
  }, []);
  // The first focus is on the name, because the button cannot have it before the files are read.
  const canOpen = open !== null && isReady(open);
  useEffect(() => {
    if (canOpen && document.activeElement?.matches(".scene-name")) document.getElementById("intake-open")?.focus();
  }, [canOpen]);
  const depth = open?.reading?.depth ?? null;
  const ground = useMemo(() => (depth === null ? null : depthImage(depth.data)), [depth]);
  if (open === null) return null;
  const inputs = draftInputs(open);
  const shown = open.reading?.photo?.rgba ?? ground;
  return (
    <dialog
      ref={dialog}
      class="intake"
      aria-labelledby="intake-title"
      onCancel={(event) => {
        // That of a file picker bubbles.
        if (event.target !== event.currentTarget) return;
        event.preventDefault();
        dismiss();
      }}
    >
      <header class="row">
        <h2 id="intake-title">{open.isEdit ? "Files" : "New scene"}</h2>
        <input
          class="scene-name"
          aria-label="Name of the scene"
          value={inputs.name}
          onInput={({ currentTarget }) => label((now) => ({ ...now, name: currentTarget.value }))}
        />
        <SceneChoice open={open} />
        <VideoChoice open={open} />
        <button type="button" id="intake-cancel" onClick={dismiss}>
          Cancel
        </button>
      </header>
      <div class="intake-body">
        <Problems field="files" />
        <ForShown open={open} />
        {inputs.depth === null && inputs.photo !== null && <FromPhoto />}
        <section aria-label="View" class="cards">
          <DepthCard open={open} ground={ground} />
          <PhotoCard open={open} />
          <CameraCard open={open} />
        </section>
        <ObjectRows open={open} ground={shown} />
        <FileRoles inputs={inputs} />
      </div>
      <footer class="row">
        <FileButton id="more-files" multiple onFiles={propose}>
          <span>Add files</span>
        </FileButton>
        <p class="quiet" role="status">
          {summary(open)}
        </p>
        <button type="button" id="intake-open" class="primary" disabled={!canOpen} onClick={accept}>
          {actionOf(open)}
        </button>
      </footer>
      <Marking open={open} ground={shown} />
    </dialog>
  );
}

/** Where depth map, mask and mesh of a photo come from. */
const FromPhoto = () => (
  <p class="from-photo">
    Drop the depth map, the mask and the mesh of this photo when you have them. The guide{" "}
    <a href="docs/from-a-photo.html" target="_blank" rel="noreferrer">
      From one photo
    </a>{" "}
    names models that make them, and says what to expect.
  </p>
);

/** Files that may belong to the scene that is shown. */
function ForShown({ open: { forShown } }: { open: Draft }) {
  if (forShown === undefined) return null;
  const names = forShown.slice(0, 3).map(({ file }) => baseName(file.path));
  return (
    <p class="doubt" id="for-shown">
      {names.join(", ")}
      {forShown.length > names.length && " …"}: for {page.inputs.value.name}, or a new scene?{" "}
      <button type="button" id="put-into-shown" onClick={putIntoShown}>
        Replace in {page.inputs.value.name}
      </button>
      <button type="button" id="new-scene" onClick={() => change((now) => now)}>
        New scene
      </button>
    </p>
  );
}

function actionOf({ isEdit, isVideo, scenes }: Draft): string {
  if (isEdit) return "Apply and align";
  return scenes.length > 1 && !isVideo ? `Align all ${scenes.length}` : "Align";
}

function summary({ reading, problems, progress: { done, total } }: Draft): string {
  if (reading === null && problems.length === 0) return total === 0 ? "Reading …" : `Reading … ${done} of ${total}`;
  const [errors, doubts] = [problems.filter(({ kind }) => kind === "error").length, problems.length];
  if (errors > 0) return errors === 1 ? "One thing is missing or wrong." : `${errors} things are missing or wrong.`;
  return doubts > 0 ? "Check what is marked, then align." : "Everything fits.";
}

function SceneChoice({ open: { scenes, index } }: { open: Draft }) {
  if (scenes.length < 2) return null;
  return (
    <label class="field-inline" for="scene-choice">
      <span>Scene</span>
      <Choices
        id="scene-choice"
        value={`${index}`}
        choices={scenes.map(({ name, depth }, i) => {
          const file = depth === null ? "" : ` (${baseName(depth.path)})`;
          return [`${i}`, `${i + 1} of ${scenes.length}: ${name}${file}`];
        })}
        onChoose={(value) => look(Number(value))}
      />
    </label>
  );
}

function VideoChoice({ open }: { open: Draft }) {
  if (!canBeVideo(open.scenes)) return null;
  return <Check id="as-video" title="Frames of one video" checked={open.isVideo} onCheck={asVideo} />;
}

const roles: readonly (readonly [Role, string])[] = [
  ["depth", "Depth map"],
  ["photo", "Photo"],
  ["camera", "Camera"],
  ["mask", "Mask"],
  ["mesh", "Mesh"],
  ["truth", "True pose"],
  ["initial", "First pose"],
  ["pose", "Pose of the camera"],
  ["resource", "Part of a mesh"],
  ["unused", "Not used"],
];

/** The form that says which file is what. It is open where only a person can tell. */
function FileRoles({ inputs: { files } }: { inputs: Inputs }) {
  if (files.length === 0) return null;
  const unused = files.filter(({ role }) => role === "unused").length;
  const asked = files.filter(isUnassigned);
  return (
    <details class="file-roles" open={asked.length > 0}>
      <summary>
        {files.length} {files.length === 1 ? "file" : "files"}
        {unused > 0 && `, ${unused} not used`}
      </summary>
      <ul>
        {[...new Set([...asked, ...files])].slice(0, 200).map(({ file, role }) => (
          <li class="row" key={file.path}>
            <span class="path" title={file.path}>
              {file.path}
            </span>
            <Choices
              label={`Use of ${baseName(file.path)}`}
              value={role}
              choices={roles}
              onChoose={(chosen) => assign(file, chosen)}
            />
          </li>
        ))}
      </ul>
    </details>
  );
}
