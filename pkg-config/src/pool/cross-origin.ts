/** Workers whose script is on another origin, such as that of a CDN. */

/**
 * Starts a worker. Browsers start workers from their own origin only, but these may import from elsewhere.
 * @param start starts it directly
 * @param script the address of its script
 */
export function startedFromAnywhere(start: () => Worker, script: () => URL): Worker {
  const { href, origin, protocol } = script();
  if (!protocol.startsWith("http") || origin === globalThis.location?.origin) return start();
  const importing = new Blob([`import ${JSON.stringify(href)};`], { type: "text/javascript" });
  return new Worker(URL.createObjectURL(importing), { type: "module" });
}
