/** The address holds the sample and the options, so that a link shows somebody else the same. */
import { computed, effect } from "@preact/signals";
import { options, optionsFromLink, optionsToLink } from "./options.js";
import { scene } from "./scene.js";

/** What the address asks for. */
export function asked(): { sample: string | null } {
  const parameters = new URLSearchParams(location.hash.slice(1));
  options.value = optionsFromLink(parameters);
  return { sample: parameters.get("sample") };
}

const hash = computed(() => {
  const sample = scene.value?.sample ?? null;
  const parts = [...(sample === null ? [] : [["sample", sample] as [string, string]]), ...optionsToLink(options.value)];
  return parts.length === 0 ? "" : `#${new URLSearchParams(parts)}`;
});

/** The link. */
export const permalink = (): string => new URL(hash.value || "#", location.href).href;

/** Keeps the address up to date. */
export function followAddress(): void {
  effect(() => {
    const next = hash.value;
    if (scene.value === null || next === location.hash) return;
    history.replaceState(null, "", next === "" ? location.pathname + location.search : next);
  });
}
