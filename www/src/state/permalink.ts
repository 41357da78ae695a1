/** The page's address holds the sample and the options, so that a link reproduces both. */
import { computed, effect } from "@preact/signals";
import { choices, defaultOptions, type Options } from "./options.js";
import { page } from "./page.js";

const { options, scene } = page;

/** Applies the options of the address, and returns the sample that it names. */
export function readAddress(): { sample: string | null } {
  const parameters = new URLSearchParams(location.hash.slice(1));
  options.value = parsedOptions(parameters);
  return { sample: parameters.get("sample") };
}

const hash = computed(() => {
  const sample = scene.value?.sample ?? null;
  const parts = [
    ...(sample === null ? [] : [["sample", sample] as [string, string]]),
    ...changedOptions(options.value),
  ];
  return parts.length === 0 ? "" : `#${new URLSearchParams(parts)}`;
});

/** The link to what the page shows. */
export const permalink = (): string => new URL(hash.value || "#", location.href).href;

/** Keeps the address up to date. */
export function updateAddress(): void {
  effect(() => {
    const next = hash.value;
    if (scene.value === null || next === location.hash) return;
    history.replaceState(null, "", next === "" ? location.pathname + location.search : next);
  });
}

/** The options that differ from the defaults. */
function changedOptions(chosen: Options): [name: string, value: string][] {
  return Object.entries(chosen)
    .filter(([name, value]) => value !== defaultOptions[name as keyof Options])
    .map(([name, value]) => [name, String(value)]);
}

/** The options of a link. Invalid values are ignored. */
function parsedOptions(parameters: URLSearchParams): Options {
  const parsed: Record<string, unknown> = { ...defaultOptions };
  for (const name of Object.keys(defaultOptions) as (keyof Options)[]) {
    const text = parameters.get(name);
    if (text === null) continue;
    const allowed: readonly string[] | undefined = (choices as Partial<Record<string, readonly string[]>>)[name];
    if (allowed !== undefined) {
      if (allowed.includes(text)) parsed[name] = text;
    } else if (text !== "" && Number(text) >= 0 && Number.isFinite(Number(text))) parsed[name] = Number(text);
  }
  return parsed as unknown as Options;
}
