/** Panels that nobody needs before the first result: they are loaded after it. */
import type { ComponentType } from "preact";
import type { ObjectModel } from "../state/object-model.js";
import { lazy } from "../ui/lazy.js";
import { useWorkspace } from "../ui/workspace.js";

interface OfObject {
  object: ObjectModel | null;
}

const later = <P extends object>(load: () => Promise<ComponentType<P>>) =>
  lazy<P>(() => useWorkspace().isSettled.value, load);

const panels = () => import("./late.js");

export const Advised = later<OfObject>(async () => (await panels()).Advised);
export const Alternatives = later<OfObject>(async () => (await panels()).Alternatives);
export const HandPanel = later(async () => (await panels()).HandPanel);
export const OptionsPanel = later(async () => (await panels()).OptionsPanel);
export const Remedies = later<OfObject>(async () => (await panels()).Remedies);
export const Details = later<OfObject>(async () => (await panels()).Details);
export const Warnings = later<OfObject>(async () => (await panels()).Warnings);
