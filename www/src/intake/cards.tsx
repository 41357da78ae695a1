/** The cards of the view: depth map, photo, camera. */
import type { ComponentChildren } from "preact";
import { useMemo } from "preact/hooks";
import { depthKinds, unitText } from "sim3align/input/depth-kinds";
import { depthKindNames, extensionsOf, type FileKind } from "sim3align/input/formats";
import { type Draft, draftInputs } from "../input/draft.js";
import { baseName } from "../input/files.js";
import { photoExtensions } from "../input/photo.js";
import { cameraTitle } from "../panels/input-rows.js";
import { depthRange } from "../pictures/colours.js";
import type { CameraSource, Field } from "../state/inputs.js";
import { Choices, FileButton, Picture } from "../ui/controls.js";
import { NumberInput } from "../ui/number-input.js";
import { percent, significant } from "../ui/texts.js";
import { ASSUMED_FOV_DEG, fovYDegOf } from "./checks.js";
import { change, choose } from "./draft.js";
import { describedBy, Problems, problemsFor } from "./problem-list.js";

interface CardProps {
  field: Exclude<Field, "files">;
  title: string;
  /** The name of the chosen file. */
  chosen: string;
  accept: string;
  children?: ComponentChildren;
}

/** A card with a file input. */
function Card({ field, title, chosen, accept, children }: CardProps) {
  const isWrong = problemsFor(field).some(({ kind }) => kind === "error");
  return (
    <div class="card" data-field={field} data-wrong={isWrong}>
      <div class="row card-head">
        <h3>{title}</h3>
        <FieldFiles field={field} title={title} accept={accept} isWrong={isWrong} />
      </div>
      <p class="path" title={chosen}>
        {chosen || "–"}
      </p>
      {children}
      <Problems field={field} general />
    </div>
  );
}

interface FieldFilesProps {
  field: Exclude<Field, "files">;
  title: string;
  accept: string;
  isWrong: boolean;
  multiple?: boolean;
}

/** The extensions of a kind of file, and others, for a file input. */
export const acceptOf = (kind: FileKind, others: readonly string[] = []): string =>
  [...new Set([...extensionsOf(kind), ...others])].map((ending) => `.${ending}`).join();

/** A button that chooses files for a field. */
export const FieldFiles = ({ field, title, isWrong, ...input }: FieldFilesProps) => (
  <FileButton
    {...input}
    id={`${field}-file`}
    aria-invalid={isWrong}
    aria-describedby={describedBy(field)}
    onFiles={(files) => choose(field, files)}
  >
    <span>
      Choose<span class="visually-hidden"> {title.toLowerCase()}</span>
    </span>
  </FileButton>
);

/** Pixels as an image of this size, as soon as both are there. */
const useImage = (rgba: Uint8ClampedArray | null, size: { width: number; height: number } | null) =>
  useMemo(() => rgba && size && new ImageData(Uint8ClampedArray.from(rgba), size.width, size.height), [rgba, size]);

/** Metres per unit of depth, as text. An empty text is the default of the reader. */
const depthUnits = [
  ["", "Auto"],
  ["1", "metres"],
  ["0.01", "centimetres"],
  ["0.001", "millimetres"],
  ["0.0001", "0.1 mm"],
  ["0.0002", "0.2 mm"],
  ["0.00025", "0.25 mm"],
] as const;

const kinds = depthKindNames.map((kind) => [kind, depthKinds[kind].title] as const);

export function DepthCard({ open, ground }: { open: Draft; ground: Uint8ClampedArray | null }) {
  const { depth: file, depthScale, depthKind } = draftInputs(open);
  const { depth = null, depthKind: read = "metric", depthUnit = null } = open.reading ?? {};
  const kind = depthKind ?? read;
  const range = useMemo(() => (depth === null ? null : depthRange(depth.data)), [depth]);
  const image = useImage(ground, depth);
  const scale = `${depthScale ?? ""}`;
  const units: readonly (readonly [string, string])[] = depthUnits;
  const choices = units.some(([own]) => own === scale) ? units : [...units, [scale, `${scale} m`] as const];
  const setScale = (factor: number) => change((now) => ({ ...now, depthScale: factor > 0 ? factor : null }));
  return (
    <Card field="depth" title="Depth map" chosen={file === null ? "" : baseName(file.path)} accept={acceptOf("depth")}>
      <Picture image={image} label="Depth map" class="shot" />
      <p class="quiet">
        {depth !== null && `${depth.width} × ${depth.height}`}
        {kind === "metric" && range !== null && `, ${range.nearM.toFixed(2)} to ${range.farM.toFixed(2)} m`}
      </p>
      <label class="field-inline" for="depth-kind">
        <span>Values</span>
        <Choices
          id="depth-kind"
          value={kind}
          choices={kinds}
          onChoose={(value) => change((now) => ({ ...now, depthKind: value }))}
        />
      </label>
      {kind === "metric" && (
        <label class="field-inline" for="depth-scale">
          <span>Unit</span>
          <Choices id="depth-scale" value={scale} choices={choices} onChoose={(value) => setScale(Number(value))} />
          <NumberInput
            id="depth-factor"
            min="0"
            placeholder="m"
            aria-label="Metres per unit"
            value={scale}
            onEnter={setScale}
          />
        </label>
      )}
      <p class="quiet" id="depth-unit">
        {depthUnit !== null &&
          (kind === "metric" ? `Unit: ${unitText(depthUnit)}` : "No unit: sizes are relative to one another.")}
      </p>
    </Card>
  );
}

export function PhotoCard({ open }: { open: Draft }) {
  const { photo: file } = draftInputs(open);
  const photo = open.reading?.photo ?? null;
  const image = useImage(photo?.rgba ?? null, photo?.shown ?? null);
  return (
    <Card
      field="photo"
      title="Photo"
      chosen={file === null ? "optional" : baseName(file.path)}
      accept={acceptOf("photo", photoExtensions)}
    >
      <Picture image={image} label="Photo" class="shot" />
      <p class="quiet">{photo !== null && `${photo.width} × ${photo.height}`}</p>
      {file !== null && (
        <button type="button" onClick={() => change((now) => ({ ...now, photo: null }))}>
          Leave out
        </button>
      )}
    </Card>
  );
}

const intrinsics = ["fx", "fy", "cx", "cy"] as const;

function chosenCamera(camera: CameraSource | null, source: string | null): string {
  if (camera === null) return source === null ? "" : cameraTitle(source);
  return camera.kind === "file"
    ? baseName(camera.file.path)
    : camera.kind === "assumed"
      ? `${camera.fovYDeg}° assumed`
      : "entered";
}

export function CameraCard({ open }: { open: Draft }) {
  const { camera } = draftInputs(open);
  const { camera: read = null, cameraSource = null, size = null, focalUncertainty = 0 } = open.reading ?? {};
  const shown = camera?.kind === "numbers" ? camera : read;
  const fovDeg = read !== null && size !== null ? fovYDegOf(read, size) : null;
  const enter = (name: (typeof intrinsics)[number], value: number) =>
    change((now) => {
      const { fx, fy, cx, cy } = shown ?? { fx: null, fy: null, cx: null, cy: null };
      const entered = { ...{ fx, fy, cx, cy }, [name]: Number.isNaN(value) ? null : value };
      return { ...now, camera: { kind: "numbers", ...entered } };
    });
  return (
    <Card field="camera" title="Camera" chosen={chosenCamera(camera, cameraSource)} accept={acceptOf("camera")}>
      <div class="camera-numbers">
        {intrinsics.map((name) => (
          <label key={name} class="field-inline">
            <span>{name}</span>
            <NumberInput
              id={`camera-${name}`}
              value={shown?.[name] == null ? "" : significant(shown[name], 7)}
              onEnter={(entered) => enter(name, entered)}
            />
          </label>
        ))}
        <label class="field-inline wide">
          <span>Vertical field of view</span>
          <NumberInput
            id="camera-fov"
            placeholder={`${ASSUMED_FOV_DEG}`}
            value={camera?.kind === "assumed" ? camera.fovYDeg : fovDeg === null ? "" : significant(fovDeg, 3)}
            onEnter={(entered) =>
              change((now) => ({ ...now, camera: { kind: "assumed", fovYDeg: entered || ASSUMED_FOV_DEG } }))
            }
          />
          <span class="unit">°</span>
        </label>
      </div>
      {focalUncertainty > 0 && <p class="quiet">Focal length ± {percent(focalUncertainty)}, refined with the poses.</p>}
      {camera !== null && (
        <button type="button" onClick={() => change((now) => ({ ...now, camera: null }))}>
          Leave out
        </button>
      )}
    </Card>
  );
}
