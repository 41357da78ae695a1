/** Every command of the page, for the palette: those with keys, and what a click on the page does. */

import { alignAll } from "../alignment/align.js";
import { applyAlternative } from "../alignment/alternatives.js";
import { allExports, type Export, listExport, videoExport } from "../export/export.js";
import { openListed, openSample } from "../opening/open.js";
import { samples } from "../opening/samples.js";
import type { ObjectModel } from "../state/object-model.js";
import { page } from "../state/page.js";
import { theme } from "../state/theme.js";
import { choices } from "../ui/choices.js";
import { reveal } from "../ui/reveal.js";
import { canNudge, keysOf, nudgeGroups } from "./nudges.js";
import { pageCommands } from "./page-commands.js";
import type { Command } from "./shortcuts.js";

const { display3d, gizmoSettings, isRunning, layers, list, measured, objects, scene, selected, setLayer, showsBefore } =
  page;

/** A command of a control that is on the page while it can be used, and what it does with it. */
const ofControl =
  (use: (control: HTMLElement) => void) =>
  (about: string, id: string): Command => {
    const control = () => document.getElementById(id);
    return {
      about,
      isOffered: () => control()?.matches(":not(:disabled, [aria-disabled='true'])") ?? false,
      act: () => {
        const found = control();
        if (found !== null) use(found);
      },
    };
  };

const press = ofControl((control) => control.click());
/** For what is to be entered: an ellipsis ends its text. */
const goTo = ofControl(reveal);

/** A command of the selected object. */
const ofObject = (
  about: string,
  act: (object: ObjectModel) => void,
  isOffered: (object: ObjectModel) => boolean = () => true,
): Command => ({
  about,
  isOffered: () => selected.peek() !== null && isOffered(selected.peek() as ObjectModel),
  act: () => act(selected.peek() as ObjectModel),
});

/** A command that changes a setting to its opposite. */
function toggle<K extends string>(about: string, of: { value: Record<K, unknown> }, name: K): Command {
  return {
    about,
    act: () => {
      of.value = { ...of.value, [name]: !of.value[name] };
    },
  };
}

const ofSelected: readonly Command[] = [
  ofObject("Show or hide the object", ({ isShown }) => {
    isShown.value = !isShown.peek();
  }),
  ofObject("Lock or unlock the pose of the object", ({ isLocked }) => {
    isLocked.value = !isLocked.peek();
  }),
  ofObject("Rename the object …", (object) => {
    page.renamed.value = object;
  }),
  ofObject("Remove the object", page.removeObject, () => objects.peek().length > 1 && !isRunning.peek()),
];

const byHand: readonly Command[] = [
  press("Fix the pose by hand", "fix"),
  goTo("Known size of the object …", "known-size"),
  goTo("Centre of the object in numbers …", "centre-x"),
  goTo("Turn the object by an angle …", "turn-deg"),
  ...nudgeGroups.flatMap((group) =>
    group.nudges.map(([title, , change], i) => ({
      ...ofObject(
        group.verb === "" ? `${title}: ${group.legend.toLowerCase()}` : `${group.verb}${title}`,
        (object) => page.nudge(object, change(object)),
        (object) => canNudge(page, object, group),
      ),
      title: keysOf(group, i),
    })),
  ),
  toggle("Handles move in steps", gizmoSettings, "snaps"),
  toggle("Handles along the axes of the mesh", gizmoSettings, "isLocal"),
];

const ofViews: readonly Command[] = [
  toggle("Show or hide the sizes", display3d, "dimensions"),
  goTo("Size of the points …", "point-size"),
  {
    about: "Before or after, in 3D",
    act: () => {
      showsBefore.value = !showsBefore.peek();
    },
  },
  {
    about: "Measure a distance",
    act: () => {
      measured.value = measured.peek() === null ? [] : null;
    },
  },
  toggle("Show or hide the mask", layers, "outline"),
  toggle("Show or hide the silhouette", layers, "silhouette"),
  {
    about: "Photo or depth map",
    isOffered: () => scene.peek()?.rgba != null,
    act: () => setLayer("base", layers.peek().base === "depth" ? "photo" : "depth"),
  },
  goTo("Wipe between before and after …", "wipe"),
];

const ofOptions: readonly Command[] = [
  ...choices.flatMap(({ title, titles, choose }) =>
    titles.map(([value, text]) => ({ about: `${title}: ${text}`, act: () => choose(page, value) })),
  ),
  goTo("Minimum scale …", "option-scaleMin"),
  goTo("Maximum scale …", "option-scaleMax"),
  goTo("Seed …", "option-seed"),
  press("Reset the options to their defaults", "reset-options"),
];

const ofFiles: readonly Command[] = [
  press("Open files …", "files"),
  press("Open a folder …", "folder"),
  press("Change or add files of the scene …", "edit-files"),
  press("Forget the scene", "forget"),
  press("Open a copy of what another tab has open", "copy-others"),
  press("Take over what another tab has open", "take-over"),
];

const ofVideos: readonly Command[] = [
  press("Previous frame", "previous-frame"),
  press("Next frame", "next-frame"),
  goTo("Frame …", "frame"),
  press("Play the frames", "play"),
  press("Track the object through the frames", "track"),
  press("Stop tracking", "stop-tracking"),
  press("Align the frames as views", "align-frames"),
  press("Use this pose in the frame", "correct"),
];

const exporting = ([title, save]: Export, isOffered = () => true): Command =>
  ofObject(
    `Export: ${title}`,
    (object) => {
      const whole = scene.peek();
      if (whole !== null) save(whole, object);
    },
    ({ isPlaced }) => isPlaced && isOffered(),
  );

const ofExports: readonly Command[] = [
  ...allExports.map((one) => exporting(one)),
  exporting(listExport, () => list.peek().length > 1),
  exporting(videoExport, () => page.video.peek() !== null),
];

const ofPage: readonly Command[] = (["system", "light", "dark"] as const).map((name) => ({
  about: `Theme: ${name}`,
  act: () => {
    theme.value = name;
  },
}));

/** What the page lists at this moment: objects, alternatives, scenes and samples. */
const ofLists = (): Command[] => [
  ...(objects.peek().length > 1 ? objects.peek() : []).map(({ id, name }) => ({
    about: `Object: ${name}`,
    act: () => page.select(id),
  })),
  ...alternativesOf(selected.peek()),
  ...(list.peek().length > 1 ? list.peek() : []).map(({ inputs }) => ({
    about: `Scene: ${inputs.name}`,
    act: () => openListed(inputs),
  })),
  ...samples.map((sample) => ({
    about: `Sample: ${sample.title}`,
    act: async () => (await openSample(sample)) && alignAll(page),
  })),
];

const alternativesOf = (object: ObjectModel | null): Command[] =>
  object?.precise == null
    ? []
    : [null, ...object.precise.alternatives].map((one, i) => ({
        title: `${i}`,
        about: one === null ? "Pose: the result" : `Pose: alternative at ${one.turnDeg.toFixed(0)}°`,
        act: () => applyAlternative(page, object, i - 1),
      }));

/** All commands that can do something now. */
export function commandsNow(): readonly Command[] {
  const all = [
    pageCommands,
    ofSelected,
    byHand,
    ofViews,
    ofOptions,
    ofFiles,
    ofVideos,
    ofLists(),
    ofExports,
    ofPage,
  ].flat();
  return all.filter(({ isOffered }) => isOffered?.() ?? true);
}
