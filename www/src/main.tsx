/** Entry point of the page. Downloads start at once and in parallel. */
import { render } from "preact";
import { loadFormats } from "sim3align/formats";
import { alignAll, alignEach } from "./alignment/align.js";
import { aligner } from "./alignment/aligner.js";
import { observePoses } from "./alignment/evaluate.js";
import { App } from "./app.js";
import { storePage } from "./offline/offline.js";
import { openFiles, openSample } from "./opening/open.js";
import { sampleOf, samples } from "./opening/samples.js";
import { hasSession, page } from "./state/page.js";
import { readAddress, updateAddress } from "./state/permalink.js";
import "../style/theme.css";
import "../style/controls.css";
import "../style/views.css";
import "../style/panels.css";
import "../style/layout.css";
import "../style/page.css";
import "../style/intake.css";

const { announce, isSettled } = page;

const named = sampleOf(readAddress().sample);
const sample = named ?? samples[0];
updateAddress();
observePoses(page);
// Needed when the files of the sample arrive.
loadFormats().catch(() => {});
aligner().catch((error) => announce(String(error), "failed"));

/** The scene that the address names. */
const address = new URLSearchParams(location.search).get("case");
const isNamed = named !== undefined || address !== null;

/** A session takes precedence over the first sample, but not over what the address names. */
async function restored(): Promise<boolean> {
  if (!hasSession() || isNamed) return false;
  return (await import("./session/index.js")).restoreSession(true);
}

/** Opens the scene at an address, as if its files were dropped. */
async function openAddress(url: string): Promise<void> {
  announce("Loading …", "working");
  try {
    await openFiles(await (await import("./opening/case-url.js")).filesAt(url));
  } catch (error) {
    announce(error instanceof Error ? error.message : `${error}`, "failed");
  }
}

const opened =
  address === null
    ? restored().then((isThere) => !isThere && sample !== undefined && openSample(sample))
    : openAddress(address).then(() => false);

const root = document.getElementById("app");
if (root !== null) render(<App />, root);

/** Not at the top level: scripts that are loaded later wait until this one has run. */
async function start(): Promise<void> {
  if (await opened) {
    // The workers would take the time of the first frame.
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    await alignEach(page);
    performance.mark("aligned");
  }
  if (sample === undefined) announce("Choose input files.");
  isSettled.value = true;
  const { keepSession, restoreSession } = await import("./session/index.js");
  // The user's own scenes are listed, whatever the address names.
  if (hasSession() && isNamed) await restoreSession(false);
  keepSession();
  (await import("./intake/queue.js")).runAhead();
  // From here on, files can be dropped without a connection. Without one now, the first drop tries again.
  import("./intake/sheet.js").catch(() => {});
  storePage();
}
start().catch((error) => {
  page.notKept.value = `A part of this page could not be loaded (${error.message}): reload it.`;
  isSettled.value = true;
});

addEventListener("unhandledrejection", ({ reason }) => announce(`${reason?.message ?? reason}`, "failed"));

addEventListener("hashchange", async () => {
  const next = sampleOf(readAddress().sample);
  if (next !== undefined && (await openSample(next))) await alignAll(page);
});
