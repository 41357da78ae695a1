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
/** The only origin that this page listens and speaks to: a page that frames it cannot choose another one. */
const origin = parameters.get("origin") ?? location.origin;

const element = new Sim3AlignElement();
const address = parameters.get("case");
if (parameters.has("readonly")) element.readonly = true;
if (address !== null) element.setAttribute("src", address);

const send = (type: string, content: object = {}) =>
  parent.postMessage({ type: `${PREFIX}${type}`, ...content }, { targetOrigin: origin });

for (const type of events) {
  element.addEventListener(type, (event) => send(type, { detail: (event as CustomEvent).detail }));
}

/** Sets what the request contains. The scene is last: it takes what was set before. */
function load(request: Request): void {
  for (const name of ["readonly", "options", "session", "pose", "scene"] as const) {
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
  if (source !== parent || from !== origin || typeof data?.type !== "string" || !data.type.startsWith(PREFIX)) return;
  answer(data as Request).catch((cause) => send("error", { id: data.id, detail: errorDetail(cause) }));
});

document.body.append(element);
if (parent !== window) send("loaded");
