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

/** What the compiler says about an element with these attributes, in an app that has copied the recipe. */
function faultsOf(attributes: string): string {
  writeFileSync(join(folder, "jsx.d.ts"), recipe);
  writeFileSync(
    join(folder, "app.tsx"),
    `import { useRef } from "react";
import type { ElementEvents, GivenScene, Sim3AlignElement } from "sim3align/element";
export function App({ scene, onPose }: { scene: GivenScene; onPose(pose: ElementEvents["posechange"]["pose"]): void }) {
  const ref = useRef<Sim3AlignElement>(null);
  return <sim3-align ${attributes} />;
}
`,
  );
  const compilerOptions = {
    ...{
      target: "es2022",
      module: "esnext",
      moduleResolution: "bundler",
      jsx: "react-jsx",
      strict: true,
      noEmit: true,
    },
    types: [],
  };
  writeFileSync(join(folder, "tsconfig.json"), JSON.stringify({ compilerOptions, include: ["*"] }));
  const tsc = join(repository, "node_modules", "typescript", "bin", "tsc");
  return spawnSync(process.execPath, [tsc, "--project", folder], { encoding: "utf8" }).stdout;
}

test("React knows the properties, events, attributes and the ref of the element", () => {
  const all = `ref={ref} scene={scene} options={{ quality: "best" }} className="a" style={{ height: 400 }} aria-label="b"
    onposechange={({ detail }) => onPose(detail.pose)} onaccept={({ detail }) => detail.isAccepted satisfies boolean}`;
  assert.equal(faultsOf(all), "");
});

test("React finds what the element does not take", () => {
  assert.match(faultsOf("scene={3}"), /TS2322/);
  assert.match(faultsOf('options={{ quality: "wrong" }}'), /TS2322/);
  assert.match(faultsOf("onposechange={({ detail }) => detail.wrong}"), /TS2339/);
});
