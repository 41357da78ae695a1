/** The package where a server renders: importing it touches nothing of a browser, and starts nothing. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import { installDir } from "../support/environment.js";

/** Names that browsers have, and servers that render lack or only pretend to have. */
const names = ["window", "document", "self", "location", "localStorage", "Worker", "HTMLElement", "customElements"];

/** Imports an entry, and prints which of the names its modules asked for. */
const script = (entry: string) => `
  const touched = new Set();
  for (const name of ${JSON.stringify(names)}) {
    Object.defineProperty(globalThis, name, {
      configurable: true,
      get() {
        // Of the package itself; three.js looks for a browser, as it may.
        const [, , caller = ""] = (new Error().stack ?? "").split("\\n");
        if (/node_modules\\/sim3align\\//.test(caller)) touched.add(name);
        return undefined;
      },
    });
  }
  const module = await import(${JSON.stringify(entry)});
  console.log(JSON.stringify({ touched: [...touched], names: Object.keys(module).length, handles: process.getActiveResourcesInfo() }));
`;

for (const entry of ["", "/inline", "/formats", "/conventions", "/simulators"].map((path) => `sim3align${path}`)) {
  test(`importing ${entry} touches no browser globals`, () => {
    const args = ["--input-type=module", "--eval", script(entry)];
    const found = JSON.parse(execFileSync(process.execPath, args, { cwd: installDir, encoding: "utf8" }));
    assert.deepEqual(found.touched, []);
    assert.ok(found.names > 0);
    const workers = found.handles.filter((handle: string) => /Worker|MessagePort|Timeout/.test(handle));
    assert.deepEqual(workers, [], "nothing runs");
  });
}

test("the element may be imported where there are no elements, and defines none", () => {
  const args = ["--input-type=module", "--eval", 'console.log(Object.keys(await import("sim3align/element")))'];
  assert.match(execFileSync(process.execPath, args, { cwd: installDir, encoding: "utf8" }), /Sim3AlignElement/);
});
