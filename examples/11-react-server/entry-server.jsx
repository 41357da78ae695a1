import { readFile } from "node:fs/promises";
import { StrictMode } from "react";
import { renderToString } from "react-dom/server";
import { createAligner } from "sim3align";
import { App } from "./app.jsx";

/** A server has one aligner. Its workers leave the thread to other requests. */
const aligner = createAligner({ workers: 1 });

/** Aligns a case folder, and renders the app with the result. */
export async function render(folder) {
  const [depth, mask, cameraFile, mesh] = await Promise.all(
    ["depth.npy", "mask.png", "camera.json", "mesh.glb"].map((name) => readFile(`${folder}/${name}`)),
  );
  const { matrix } = await (await aligner).align({ depth, mask, cameraFile, mesh }, { quality: "fast" });
  const first = [...matrix];
  const html = renderToString(
    <StrictMode>
      <App first={first} load={() => null} />
    </StrictMode>,
  );
  return { html, first };
}
