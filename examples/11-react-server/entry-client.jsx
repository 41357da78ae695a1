import { StrictMode } from "react";
import { hydrateRoot } from "react-dom/client";
import { App } from "./app.jsx";

const fetched = async (name) => (await fetch(`/mug/${name}`)).arrayBuffer();

/** The files of the case; the package decodes them in its workers. */
async function load() {
  const [depth, mask, cameraFile, mesh] = await Promise.all(
    ["depth.npy", "mask.png", "camera.json", "mesh.glb"].map(fetched),
  );
  return { depth, mask, cameraFile, mesh };
}

const first = JSON.parse(document.querySelector("#data").textContent);
hydrateRoot(
  document.querySelector("#root"),
  <StrictMode>
    <App first={first} load={load} />
  </StrictMode>,
);
