/** The result and its alternatives, as pictures. */
import { useMemo } from "preact/hooks";
import { applyAlternative, shownAlternative } from "../alignment/align.js";
import { poseThumbnail } from "../pictures/pose-thumbnail.js";
import type { ObjectModel } from "../state/object-model.js";
import { Picture } from "../ui/controls.js";
import { useWorkspace } from "../ui/workspace.js";
import { imageOf } from "../views/image.js";

/** Width and height of a picture in pixels. */
const SIZE = 88;
const MOST = 5;

export function Alternatives({ object }: { object: ObjectModel | null }) {
  const workspace = useWorkspace();
  const best = object?.precise ?? null;
  const alternatives = best?.alternatives.slice(0, MOST) ?? [];
  if (object === null || best === null) return null;
  if (alternatives.length === 0) return <p class="quiet">No plausible alternatives.</p>;
  const shown = shownAlternative(object);
  return (
    <fieldset class="row alternatives">
      <legend>Alternatives, by their rotation from the best</legend>
      {[best, ...alternatives].map((pose, i) => (
        <button
          key={`${i} ${pose.matrix[0]}`}
          type="button"
          class="choice"
          aria-pressed={shown === i - 1}
          onClick={() => applyAlternative(workspace, object, i - 1)}
        >
          <PosePicture object={object} matrix={pose.matrix} />
          <span>{i === 0 ? "Best" : `${(alternatives[i - 1]?.turnDeg ?? 0).toFixed(0)}°`}</span>
        </button>
      ))}
    </fieldset>
  );
}

function PosePicture({ object, matrix }: { object: ObjectModel; matrix: ArrayLike<number> }) {
  const { drawn, ground } = imageOf(useWorkspace());
  const [around, rgba] = [drawn.value, ground.value];
  const image = useMemo(() => {
    const { mesh, colour } = object;
    if (around === null || rgba === null) return null;
    return poseThumbnail({ mesh, matrix, mask: around.maskOf(object), colour }, { ...around, rgba }, SIZE);
  }, [object, matrix, around, rgba]);
  return <Picture image={image} label="" class="thumb" />;
}
