import { Canvas, useThree } from "@react-three/fiber";
import { useLayoutEffect, useMemo } from "react";
import { applyPinhole, applyToObject3D } from "sim3align/three";
import { PerspectiveCamera } from "three";

/** The canvas covers the photo. */
const over = { position: "absolute", inset: 0 };

/**
 * A canvas whose camera is the camera of the photo: what is placed by a result is drawn where the photo shows it.
 * `camera` holds fx, fy, cx, cy in pixels; `width` and `height` are the size of the photo or depth map that they belong to.
 */
export function PhotoCanvas({ camera: { fx, fy, cx, cy }, width, height, photo = null, children }) {
  const camera = useMemo(() => {
    const own = new PerspectiveCamera();
    applyPinhole(own, { fx, fy, cx, cy }, { width, height });
    // Otherwise the canvas replaces the aspect with its own when it is resized.
    own.manual = true;
    return own;
  }, [fx, fy, cx, cy, width, height]);
  return (
    // The canvas has the aspect ratio of the image, at any size.
    <div className="photo" style={{ aspectRatio: `${width} / ${height}` }}>
      {photo !== null && <img src={photo} alt="" style={{ ...over, inlineSize: "100%" }} />}
      <Canvas camera={camera} frameloop="demand" gl={{ preserveDrawingBuffer: true }} style={over}>
        {children}
      </Canvas>
    </div>
  );
}

/** A three.js object at the pose of a result. Its parent is the scene, whose origin is the camera. */
export function Placed({ object, pose }) {
  const invalidate = useThree((state) => state.invalidate);
  useLayoutEffect(() => {
    applyToObject3D(object, pose);
    invalidate();
  }, [object, pose, invalidate]);
  return <primitive object={object} />;
}
