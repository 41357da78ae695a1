import { StrictMode, use, useState } from "react";
import { createRoot } from "react-dom/client";
import { Mesh, MeshBasicMaterial } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import "sim3align/element";
import { PhotoCanvas, Placed } from "./photo-canvas.jsx";

const folder = `${import.meta.env.BASE_URL}mug/`;
const fetched = async (name) => (await fetch(folder + name)).blob();

/** The files of the case. The property `scene` is this one object: another one would be another scene. */
const loading = (async () => {
  const [depth, mask, mesh, camera] = await Promise.all([
    ...["depth.npy", "mask.png", "mesh.glb"].map(fetched),
    fetch(`${folder}camera.json`).then((response) => response.json()),
  ]);
  const { scene: object } = await new GLTFLoader().loadAsync(`${folder}mesh.glb`);
  object.traverse((part) => {
    if (part instanceof Mesh) part.material = new MeshBasicMaterial({ color: 0xff7a1a });
  });
  return { scene: { name: "Mug", depth, camera, objects: [{ name: "mug", mask, mesh }] }, camera, object };
})();

function App() {
  const { scene, camera, object } = use(loading);
  const [pose, setPose] = useState(null);
  const [status, setStatus] = useState({ state: "working", text: "Aligning …" });
  // React 19 sets properties of custom elements, and listens to their events. Older versions need a ref for both.
  return (
    <>
      <p id="status" data-state={status.state}>
        {status.text}
      </p>
      <sim3-align
        scene={scene}
        onposechange={({ detail }) => setPose(detail.pose)}
        onalign={({ detail: { objects } }) =>
          setStatus({ state: "done", text: `Confidence ${objects[0].confidence.toFixed(2)}` })
        }
        onaccept={({ detail }) => detail.isAccepted && setStatus({ state: "done", text: `Accepted ${detail.name}` })}
        onerror={({ detail }) => setStatus({ state: "failed", text: detail.message })}
      />
      <PhotoCanvas camera={camera} width={camera.width} height={camera.height}>
        {pose !== null && <Placed object={object} pose={pose} />}
      </PhotoCanvas>
    </>
  );
}

createRoot(document.querySelector("#root")).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
