/** Panels that are loaded after the first result. */
import type { ComponentType } from "preact";
import type { ObjectModel } from "../state/object-model.js";
import { lazy } from "../ui/lazy.js";
import { useWorkspace } from "../ui/workspace.js";

interface OfObject {
  object: ObjectModel | null;
}

const whenSettled = <P extends object>(load: () => Promise<ComponentType<P>>) =>
  lazy<P>(() => useWorkspace().isSettled.value, load);

export const Advised = whenSettled<OfObject>(async () => (await import("./advised.js")).Advised);
export const Alternatives = whenSettled<OfObject>(async () => (await import("./alternatives.js")).Alternatives);
export const HandPanel = whenSettled(async () => (await import("./hand-panel.js")).HandPanel);
export const OptionsPanel = whenSettled(async () => (await import("./options-panel.js")).OptionsPanel);
export const Remedies = whenSettled<OfObject>(async () => (await import("./remedies.js")).Remedies);
export const Details = whenSettled<OfObject>(async () => (await import("./details.js")).Details);
export const Warnings = whenSettled<OfObject>(async () => (await import("./advised.js")).Warnings);
