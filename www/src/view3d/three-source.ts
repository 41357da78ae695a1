/** Where the 3D view of the element gets three.js: from the copy of the package, or from that of the app. */

type Three = typeof import("./three.js");

/** None on the demo page, whose 3D view imports three.js itself. */
let source: (() => Promise<Three>) | undefined;
let loaded: Three | undefined;

/** Sets the source, before the first 3D view. */
export function takeThreeFrom(other: () => Promise<Three>): void {
  source = other;
}

/** Loads three.js, before the first module that uses it. */
export async function loadThree(): Promise<void> {
  loaded ??= await source?.();
}

/** What has been loaded. */
export const three = (): Three => loaded as Three;
