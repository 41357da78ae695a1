/** Workers whose script is on another origin, such as that of a CDN. */

/** The addresses of scripts that import one from elsewhere, by its address: each worker would hold another one. */
const importing = new Map<string, string>();

/**
 * Starts a worker. Browsers start workers from their own origin only, but these may import from elsewhere.
 * @param start starts it directly
 * @param script the address of its script
 */
export function startedFromAnywhere(start: () => Worker, script: () => URL): Worker {
  const { href, origin, protocol } = script();
  if (!protocol.startsWith("http") || origin === globalThis.location?.origin) return start();
  const made =
    importing.get(href) ??
    URL.createObjectURL(new Blob([`import ${JSON.stringify(href)};`], { type: "text/javascript" }));
  importing.set(href, made);
  return new Worker(made, { type: "module" });
}
