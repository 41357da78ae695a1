/** The problems of a field, with buttons that help. */

import { draft } from "../input/draft.js";
import type { Problem } from "../input/problems.js";
import type { Field } from "../state/inputs.js";
import { change } from "./draft.js";

/** The problems of a field; with an object, those of it. */
export function problemsFor(field: Field, object?: number): readonly Problem[] {
  const all = (draft.value?.problems ?? []).filter((one) => one.field === field);
  return object === undefined ? all : all.filter((one) => one.object === object);
}

/** The id of the element that lists the problems of a field. */
const errorId = (field: Field, object?: number) => `${field}-error${object === undefined ? "" : `-${object}`}`;

/** The ids of all elements with problems of a field, for `aria-describedby`; undefined for none. */
export function describedBy(field: Field): string | undefined {
  const ids = new Set(problemsFor(field).map(({ object }) => errorId(field, object)));
  return ids.size === 0 ? undefined : [...ids].join(" ");
}

interface ProblemsProps {
  field: Field;
  object?: number;
  /** Only those that concern no single object. */
  general?: boolean;
}

export function Problems({ field, object, general = false }: ProblemsProps) {
  const found = problemsFor(field, object).filter((one) => !general || one.object === undefined);
  if (found.length === 0) return null;
  return (
    <div id={errorId(field, object)} role="alert">
      {found.map(({ message, kind, remedies }) => (
        <p key={message} class={kind === "error" ? "error" : "doubt"}>
          {message}{" "}
          {remedies.map(({ title, apply }) => (
            <button key={title} type="button" onClick={() => change(apply, true)}>
              {title}
            </button>
          ))}
        </p>
      ))}
    </div>
  );
}
