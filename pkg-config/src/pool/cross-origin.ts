/** Workers whose script is on another origin, such as that of a CDN. */

import { oncePerKey } from "../values/validation.js";

/** The address of a script that imports the one at an address: the browser would keep another one for each worker. */
const importing = oncePerKey((address: string) =>
  URL.createObjectURL(new Blob([`import ${JSON.stringify(address)};`], { type: "text/javascript" })),
);

/**
 * Starts a worker. Browsers start workers from their own origin only, but these may import from elsewhere.
 * @param start starts it directly
 * @param script the address of its script
 */
export function startedFromAnywhere(start: () => Worker, script: () => URL): Worker {
  const { href, origin, protocol } = script();
  if (!protocol.startsWith("http") || origin === globalThis.location?.origin) return start();
  return new Worker(importing(href), { type: "module" });
}
