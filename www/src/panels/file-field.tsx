/** An input field for files, with its error. */
import type { ComponentChildren } from "preact";
import { filesOf } from "../load/files.js";
import type { Field } from "../load/inputs.js";
import { fieldErrors, openFiles } from "../load/open.js";

interface FileFieldProps {
  field: Field;
  title: string;
  /** Names of the chosen files. */
  chosen: string;
  accept: string;
  multiple?: boolean;
  children?: ComponentChildren;
}

export function FileField({ field, title, chosen, accept, multiple = false, children }: FileFieldProps) {
  const error = fieldErrors.value[field];
  const errorId = `${field}-error`;
  return (
    <div class="file-field" data-field={field} data-wrong={error !== undefined}>
      <span class="file-title" id={`${field}-title`}>
        {title}
      </span>
      <span class="file-name" title={chosen}>
        {chosen || "none"}
      </span>
      <label class="button">
        <span>
          Choose<span class="visually-hidden"> {title.toLowerCase()}</span>
        </span>
        <input
          id={`${field}-file`}
          class="visually-hidden"
          type="file"
          accept={accept}
          multiple={multiple}
          aria-invalid={error !== undefined}
          aria-describedby={error === undefined ? undefined : errorId}
          onChange={({ currentTarget }) => {
            const files = filesOf(currentTarget);
            // Otherwise choosing the same file again, for example after correcting it, would fire no event.
            currentTarget.value = "";
            if (files.length > 0) openFiles(files, field);
          }}
        />
      </label>
      {children}
      {error !== undefined && (
        <p class="error" id={errorId} role="alert">
          {error.message} {error.remedy}
        </p>
      )}
    </div>
  );
}
