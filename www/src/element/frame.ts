/** The page for iframes: one `<sim3-align>` that a parent page controls by messages. `docs/guides/embedding.md` lists them. */
import { errorDetail } from "./events.js";
import { Sim3AlignElement } from "./index.js";

/** The names of the messages to the parent, without their prefix. */
const events = ["ready", "progress", "align", "posechange", "accept", "error"] as const;

const PREFIX = "sim3align:";

/** What a parent may ask. */
interface Request {
  type: string;
  /** Returned with the answer. */
  id?: unknown;
  scene?: unknown;
  pose?: unknown;
  options?: unknown;
  session?: unknown;
  readonly?: unknown;
}

const parameters = new URLSearchParams(location.search);
/**
 * The origins that this page listens and speaks to: its own, and those that it names itself. Whoever frames it chooses its
 * address, and must not choose these.
 */
const origins = new Set([location.origin]);
for (const meta of document.querySelectorAll<HTMLMetaElement>('meta[name="sim3align-parents"]')) {
  for (const address of meta.content.split(/\s+/).filter(Boolean)) origins.add(new URL(address).origin);
}
if (parameters.has("origin")) {
  const remedy =
    'Name its origin in the page of the frame: <meta name="sim3align-parents" content="https://app.example">.';
  console.warn(`sim3align: the parameter origin is ignored: a frame does not trust whoever embeds it. ${remedy}`);
}
/** Those that the parent may have: where the browser does not tell its origin, it delivers to that one only. */
const { ancestorOrigins } = location as { ancestorOrigins?: DOMStringList };
const parents = [...origins].filter((one) => ancestorOrigins === undefined || one === ancestorOrigins[0]);

const element = new Sim3AlignElement();
const address = parameters.get("case");
if (parameters.has("readonly")) element.readonly = true;
if (address !== null) element.setAttribute("src", address);

function send(type: string, content: object = {}): void {
  for (const targetOrigin of parents) parent.postMessage({ type: `${PREFIX}${type}`, ...content }, { targetOrigin });
}

for (const type of events) {
  element.addEventListener(type, (event) => send(type, { detail: (event as CustomEvent).detail }));
}

/** Sets what the request contains. What follows the scene is for it. */
function load(request: Request): void {
  for (const name of ["readonly", "options", "scene", "session", "pose"] as const) {
    if (name in request) Object.assign(element, { [name]: request[name] });
  }
}

async function answer(request: Request): Promise<void> {
  const { id } = request;
  const results = () => ({ id, results: element.results, session: element.session });
  switch (request.type.slice(PREFIX.length)) {
    case "load":
      return load(request);
    case "align":
      await element.align();
      return send("results", results());
    case "get":
      return send("results", results());
    default:
      throw new TypeError(`Unknown message ${request.type}. Known: load, align, get.`);
  }
}

addEventListener("message", ({ source, origin: from, data }: MessageEvent<Partial<Request> | null>) => {
  if (source !== parent || !origins.has(from) || typeof data?.type !== "string" || !data.type.startsWith(PREFIX))
    return;
  answer(data as Request).catch((cause) => send("error", { id: data.id, detail: errorDetail(cause) }));
});

document.body.append(element);
if (parent !== window) send("loaded");
