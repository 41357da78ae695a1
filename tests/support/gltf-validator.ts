/** Khronos' own judgement of glTF files. */
import assert from "node:assert/strict";
import { createRequire } from "node:module";

interface Report {
  issues: { numErrors: number; numWarnings: number; messages: { code: string; message: string; pointer?: string }[] };
  info: { totalVertexCount: number; totalTriangleCount: number };
}

// The package has no types.
const { validateBytes } = createRequire(import.meta.url)("gltf-validator") as {
  validateBytes(bytes: Uint8Array): Promise<Report>;
};

/** Checks that a file is without errors and warnings; returns what the validator says about it. */
export async function assertValid(glb: Uint8Array): Promise<Report["info"]> {
  const { issues, info } = await validateBytes(glb);
  const serious = issues.messages.map(({ code, message, pointer }) => `${code} ${message} ${pointer ?? ""}`);
  assert.equal(issues.numErrors + issues.numWarnings, 0, serious.join("\n"));
  return info;
}
