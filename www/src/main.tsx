/** The page's beginning: what takes long is begun at once, and side by side. */
import { render } from "preact";
import { loadFormats } from "sim3align/formats";
import { App } from "./app.js";
import { openSample } from "./load/open.js";
import { sampleOf, samples } from "./load/samples.js";
import { alignAll } from "./run/align.js";
import { aligner } from "./run/aligner.js";
import { followPoses } from "./run/evaluate.js";
import { say } from "./state/announcement.js";
import { asked, followAddress } from "./state/permalink.js";
import { isSettled } from "./views/space.js";
import "../style/theme.css";
import "../style/layout.css";
import "../style/controls.css";
import "../style/views.css";
import "../style/panels.css";

const sample = sampleOf(asked().sample) ?? samples[0];
followAddress();
followPoses();
// The sample's files need it as soon as they are there.
loadFormats().catch(() => {});
aligner().then(
  () => performance.mark("aligner ready"),
  (error) => say(String(error), "failed"),
);
const opened = sample === undefined ? Promise.resolve(false) : openSample(sample);

const root = document.getElementById("app");
if (root !== null) render(<App />, root);

if (await opened) {
  performance.mark("opened");
  await alignAll();
  performance.mark("aligned");
}
if (sample === undefined) say("Choose files to begin.");
isSettled.value = true;

addEventListener("hashchange", async () => {
  const next = sampleOf(asked().sample);
  if (next !== undefined && (await openSample(next))) await alignAll();
});
