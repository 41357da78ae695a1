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

const panels = () => import("./after-result.js");

export const Advised = whenSettled<OfObject>(async () => (await panels()).Advised);
export const Alternatives = whenSettled<OfObject>(async () => (await panels()).Alternatives);
export const HandPanel = whenSettled(async () => (await panels()).HandPanel);
export const OptionsPanel = whenSettled(async () => (await panels()).OptionsPanel);
export const Remedies = whenSettled<OfObject>(async () => (await panels()).Remedies);
export const Details = whenSettled<OfObject>(async () => (await panels()).Details);
export const Warnings = whenSettled<OfObject>(async () => (await panels()).Warnings);
