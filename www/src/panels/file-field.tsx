/** A file's field: which it is, another one, and what is wrong with it. */
import type { ComponentChildren } from "preact";
import type { Field } from "../load/inputs.js";
import { fromFile } from "../load/named-file.js";
import { fieldErrors, openFiles } from "../load/open.js";

interface FileFieldProps {
  field: Field;
  title: string;
  /** The chosen files' names. */
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
            const files = Array.from(currentTarget.files ?? [], (file) => fromFile(file));
            // The same file may be chosen again, once it has been corrected.
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
