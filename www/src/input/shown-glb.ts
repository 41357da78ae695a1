/** Binary glTF files for the 3D view. */
import { gltfText } from "sim3align/input/webp";

/** A mesh file if it is a binary glTF that the view can load as it is: it holds its buffers and images, and is not compressed. */
export function shownGlb(bytes: Uint8Array): Uint8Array | null {
  const json = gltfText(bytes);
  const isBinary = json !== "" && bytes[0] === 0x67;
  return isBinary && !/_meshopt_|_draco_|"uri"\s*:\s*"(?!data:)/.test(json) ? bytes : null;
}
