/** The declaration of the element in JSX, which the guide asks users of TypeScript to copy. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { repository } from "../support/environment.js";
import { examplesDir } from "../support/examples.js";

// Beside the examples, whose packages it uses.
const folder = join(examplesDir, "10-react", "typed");
mkdirSync(folder, { recursive: true });
after(() => rmSync(folder, { recursive: true, force: true }));

const guide = readFileSync(join(repository, "docs", "guides", "embedding.md"), "utf8");
const [, recipe = ""] = /```tsx\n([\s\S]*?)```/.exec(guide) ?? [];

const app = (attributes: string) => `import { useRef } from "react";
import type { ElementEvents, GivenScene, Sim3AlignElement } from "sim3align/element";
export function App({ scene, onPose }: { scene: GivenScene; onPose(pose: ElementEvents["posechange"]["pose"]): void }) {
  const ref = useRef<Sim3AlignElement>(null);
  return <sim3-align ${attributes} />;
}
`;
const compilerOptions = {
  ...{ target: "es2022", module: "esnext", moduleResolution: "bundler", jsx: "react-jsx", strict: true, noEmit: true },
  types: [],
};
const tsc = join(repository, "node_modules", "typescript", "bin", "tsc");

test("React knows what the element takes, and finds what it does not take", () => {
  const right = `ref={ref} scene={scene} options={{ quality: "best" }} className="a" style={{ height: 400 }} aria-label="b"
    onposechange={({ detail }) => onPose(detail.pose)} onaccept={({ detail }) => detail.isAccepted satisfies boolean}`;
  const wrong = ["scene={3}", 'options={{ quality: "wrong" }}', "onposechange={({ detail }) => detail.wrong}"];
  writeFileSync(join(folder, "jsx.d.ts"), recipe);
  writeFileSync(join(folder, "tsconfig.json"), JSON.stringify({ compilerOptions, include: ["*"] }));
  for (const [i, attributes] of [right, ...wrong].entries())
    writeFileSync(join(folder, `app-${i}.tsx`), app(attributes));
  const { stdout } = spawnSync(process.execPath, [tsc, "--project", folder], { encoding: "utf8" });
  const faults = Array.from(stdout.matchAll(/app-(\d)\.tsx.*error (TS\d+)/g), ([, file, code]) => `${file} ${code}`);
  assert.deepEqual(faults.sort(), ["1 TS2322", "2 TS2322", "3 TS2339"], stdout);
});
