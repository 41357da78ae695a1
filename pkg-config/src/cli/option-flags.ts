/** Flags for the options in the generated option tables. */
import { InvalidArgumentError } from "commander";
import type { OptionRow } from "../types/options.js";
import {
  type Flag,
  type FlagList,
  type FlagSettings,
  type Flags,
  nameOf,
  reads,
  valueName,
  withoutTitles,
} from "./flags.js";
import { direction, guard, number, scale, symmetry } from "./parse.js";

/** Flags that are shorter than their option's name. */
const FLAG_NAMES: Readonly<Record<string, string>> = { knownExtentM: "known-extent" };

/** Options that do nothing without others. `--options` has them by the names of the API. */
const NEEDS: Readonly<Record<string, Pick<FlagSettings, "needs">>> = {
  knownExtentAxis: { needs: { oneOf: ["knownExtent", "knownExtentM"], what: "--known-extent" } },
};

/** The flag of an option, without the dashes: `known-extent-axis` for `knownExtentAxis`. */
export const flagName = ({ name }: Pick<OptionRow, "name">) =>
  FLAG_NAMES[name] ?? name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);

/** A message about options, with the flags that the command has for them: `--mesh-up` for `options.meshUp`. */
export function inFlags(message: string, list: FlagList): string {
  const flags = new Map(withoutTitles(list).map(([flag]) => [nameOf(flag).replace(/^--(no-)?/, ""), nameOf(flag)]));
  return message.replace(
    /\boptions\.(\w+)|`(\w+)`/g,
    (text, option?: string, quoted?: string) => flags.get(flagName({ name: option ?? quoted ?? "" })) ?? text,
  );
}

/** Whether the flag disables an option that is on by default. */
const isNegated = ({ kind, default: value }: OptionRow) => kind === "boolean" && value === true;

/** A flag for each option. */
export const optionFlags = (rows: readonly OptionRow[]): Flag[] =>
  rows.map((row) => {
    const flag = isNegated(row) ? `--no-${flagName(row)}` : `--${flagName(row)}`;
    const { value, parse } = kinds[row.kind];
    const file = row.kind === "transform" ? { ...reads, isReplaceable: true } : {};
    const parsed = parse === undefined ? {} : { parse: (text: string) => parse(text, row) };
    return [`${flag}${value(row.name)}`, meaning(row, rows), { ...file, ...parsed, ...NEEDS[row.name] }];
  });

/** The values of the options whose flags are set. The value of a transform is the path of its file. */
export function optionValues(flags: Flags, rows: readonly OptionRow[]): Record<string, unknown> {
  const values: Record<string, unknown> = {};
  for (const row of rows) {
    const value = flags[valueName(`--${flagName(row)}`)];
    // Commander sets `true` for a --no flag that is not on the command line.
    if (value === undefined || (isNegated(row) && value === true)) continue;
    values[row.name] = value === "none" && row.isNullable ? null : value;
  }
  return values;
}

/** The summary of an option with its values and default. Option names in it are replaced by flags. */
function meaning(row: OptionRow, rows: readonly OptionRow[]): string {
  const summary = row.summary.replace(/`(\w+)`/g, (quoted, name: string) => {
    const named = rows.find((other) => other.name === name);
    // What only a --no flag changes has no flag of its own name.
    return named === undefined || isNegated(named) ? quoted : `--${flagName(named)}`;
  });
  const facts = [valuesOf(row), defaultOf(row)].filter((fact) => fact !== undefined).join("; ");
  const text = isNegated(row) ? negated(summary) : lowered(summary);
  return (facts === "" ? text : `${text} (${facts})`).replaceAll("`", "");
}

/** The summary of what is done by default, for the flag that turns it off. */
function negated(summary: string): string {
  const action = /^Whether to (.*)$/.exec(summary)?.[1];
  if (action !== undefined) return `do not ${action}`;
  return `by default, ${summary.replace(/^Whether /, "")}; this turns it off`;
}

const lowered = (text: string) => (/^[A-Z][a-z]/.test(text) ? text.charAt(0).toLowerCase() + text.slice(1) : text);

function valuesOf({ min, max, above, choices }: OptionRow): string | undefined {
  if (choices !== undefined) return choices.join(", ");
  if (min !== undefined && max !== undefined) return `${min} to ${max}`;
  return above === undefined ? undefined : `above ${above}`;
}

const defaultOf = ({ kind, default: value }: OptionRow) =>
  value === null || kind === "boolean" ? undefined : `default ${Array.isArray(value) ? value.join(",") : value}`;

const unit = (name: string) => (name.endsWith("M") ? " <metres>" : name.endsWith("Deg") ? " <degrees>" : " <x>");

/** The value and the parser of the flags of each kind of option, by the name of the option. */
const kinds: Readonly<
  Record<OptionRow["kind"], { value: (name: string) => string; parse?: (text: string, row: OptionRow) => unknown }>
> = {
  integer: { value: () => " <n>", parse: number },
  number: { value: unit, parse: number },
  boolean: { value: () => "" },
  choice: { value: () => " <name>", parse: (text, { choices = [] }) => chosen(text, choices) },
  scale: { value: () => " <free|a|min,max>", parse: scale },
  direction: { value: () => " <x,y,z>", parse: direction },
  symmetry: { value: () => " <name|json>", parse: symmetry },
  transform: { value: () => " <file>" },
  guard: { value: () => " <min,max|none>", parse: guard },
};

function chosen(text: string, choices: readonly string[]): string {
  if (choices.includes(text)) return text;
  throw new InvalidArgumentError(`Allowed choices are ${choices.join(", ")}.`);
}
