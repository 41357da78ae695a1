/**
 * Keeps the page for use without a connection. The build writes this file beside the page, with the names of its files.
 * Files of the build have names by content, so the stored ones are right for ever. All others come from the network first: a
 * new version is there at the next load, and a server for development shows every change.
 */
/* global BUILD, FILES */
const cacheName = `sim3align-${BUILD}`;
const urls = new Set(FILES.map((file) => new URL(file, registration.scope).href));

addEventListener("install", (event) => event.waitUntil(store()));

/** Stores all files, a few at a time: the page may be loading others. */
async function store() {
  const cache = await caches.open(cacheName);
  const left = [...urls];
  const next = async () => {
    for (let url = left.shift(); url !== undefined; url = left.shift()) {
      if ((await cache.match(url)) !== undefined) continue;
      const response = await fetch(url, { cache: "no-cache" });
      if (!response.ok) throw new Error(`${url}: HTTP ${response.status}`);
      await cache.put(url, response);
    }
  };
  await Promise.all([next(), next(), next()]);
}

addEventListener("activate", (event) => event.waitUntil(activate()));

/** Begins to serve, and forgets earlier builds: no page of them is open any more. */
async function activate() {
  for (const name of await caches.keys()) {
    if (name.startsWith("sim3align-") && name !== cacheName) await caches.delete(name);
  }
  await clients.claim();
}

addEventListener("fetch", (event) => {
  const { request } = event;
  const url = new URL(request.url);
  const address = url.origin + url.pathname;
  if (request.method !== "GET" || !urls.has(address)) return;
  event.respondWith(answer(request, address));
});

async function answer(request, address) {
  const stored = () => caches.open(cacheName).then((cache) => cache.match(address));
  if (address.includes("/assets/")) return (await stored()) ?? fetch(request);
  try {
    return await fetch(request);
  } catch (error) {
    const found = await stored();
    if (found === undefined) throw error;
    return found;
  }
}
