/** The field in which the name of an object is changed. */
import { useLayoutEffect, useRef } from "preact/hooks";
import type { ObjectModel } from "../state/object-model.js";
import { useWorkspace } from "../ui/workspace.js";

export function NameField({ object }: { object: ObjectModel }) {
  const { renamed } = useWorkspace();
  const { name } = object;
  const field = useRef<HTMLInputElement>(null);
  // At once: the next key belongs to the name.
  useLayoutEffect(() => {
    field.current?.focus();
    field.current?.select();
  }, []);
  return (
    <input
      class="rename"
      aria-label={`New name of ${name}`}
      value={name}
      ref={field}
      onKeyDown={({ key, currentTarget }) => {
        if (key === "Escape") currentTarget.value = name;
        if (key !== "Enter" && key !== "Escape") return;
        const row = currentTarget.parentElement;
        currentTarget.blur();
        // The focus would be lost with the field.
        requestAnimationFrame(() => row?.querySelector("button")?.focus());
      }}
      onBlur={({ currentTarget }) => {
        object.title.value = currentTarget.value.trim() || name;
        renamed.value = null;
      }}
    />
  );
}
