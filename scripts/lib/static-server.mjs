/** A web server for built pages, on this machine only. */

/**
 * Serves a folder.
 * @param {string} folder an absolute path
 * @param {number} [port] the next free one where it is taken; 0 is any free one
 * @returns {Promise<{ url: string, close: () => Promise<void> }>} the address, ending in a slash
 */
export async function serve(folder, port = 0) {
  // The set-up installs it first.
  const { preview } = await import("vite");
  const server = await preview({
    configFile: false,
    root: folder,
    appType: "mpa",
    logLevel: "silent",
    build: { outDir: folder },
    preview: { host: "127.0.0.1", port, open: false, headers: { "cache-control": "no-store" } },
  });
  const [url = ""] = server.resolvedUrls?.local ?? [];
  return { url, close: () => server.close() };
}
