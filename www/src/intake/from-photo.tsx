/** Where depth map, mask and mesh of a photo come from. */
import type { Inputs } from "../state/inputs.js";
import { MarkButton } from "./marking.js";

type Source = readonly [title: string, address: string];

const depthModels: readonly Source[] = [
  ["Depth Pro", "https://github.com/apple/ml-depth-pro"],
  ["MoGe", "https://github.com/microsoft/MoGe"],
  ["Depth Anything 3", "https://github.com/ByteDance-Seed/Depth-Anything-3"],
];
const maskModels: readonly Source[] = [["SAM 2", "https://github.com/facebookresearch/sam2"]];
const meshModels: readonly Source[] = [
  ["SAM 3D Objects", "https://github.com/facebookresearch/sam-3d-objects"],
  ["TRELLIS", "https://github.com/microsoft/TRELLIS"],
  ["Hunyuan3D", "https://github.com/Tencent-Hunyuan/Hunyuan3D-2"],
];

/** The guide, which is beside the page. */
const GUIDE = "docs/from-a-photo.html";

/** `canMark` says whether the photo is there to be marked. */
export function FromPhoto({ inputs: { photo, objects }, canMark }: { inputs: Inputs; canMark: boolean }) {
  if (photo === null) return null;
  const has = (part: "mask" | "mesh") => objects.some((object) => object[part] !== null);
  const rows: readonly (readonly [title: string, isThere: boolean, text: string, sources: readonly Source[]])[] = [
    ["Depth map", false, "A depth model guesses it from this photo: save its values as NPZ, NPY or EXR.", depthModels],
    ["Mask", has("mask"), "Mark the object on the photo, or take the mask of a segmentation model.", maskModels],
    ["Mesh", has("mesh"), "A generative model makes it from this photo, or use a scan.", meshModels],
  ];
  return (
    <section class="from-photo" aria-labelledby="from-photo-title">
      <h3 id="from-photo-title">From one photo</h3>
      <ul>
        {rows.map(([title, isThere, text, sources]) => (
          <li key={title} data-there={isThere}>
            <strong>
              {isThere ? "✓ " : ""}
              {title}
            </strong>{" "}
            {text}{" "}
            {sources.map(([name, address]) => (
              <a key={name} href={address} target="_blank" rel="noreferrer">
                {name}
              </a>
            ))}
            {title === "Mask" && !isThere && canMark && <MarkButton i={0} id="mark-mask" title="Mark it" />}
          </li>
        ))}
      </ul>
      <p>
        Drop the files here when you have them. The guide{" "}
        <a href={GUIDE} target="_blank" rel="noreferrer">
          From one photo
        </a>{" "}
        says what each model returns, and what to expect.
      </p>
    </section>
  );
}
