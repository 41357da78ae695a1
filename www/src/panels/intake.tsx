/** Shows the intake sheet while there is a draft. */
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { draft } from "../state/draft.js";

const sheet = signal<typeof import("../intake/index.js").Sheet | null>(null);

export function Intake() {
  const isOpen = draft.value !== null;
  useEffect(() => {
    if (isOpen && sheet.peek() === null) {
      import("../intake/index.js").then(({ Sheet }) => {
        sheet.value = Sheet;
      }, console.error);
    }
  }, [isOpen]);
  const Loaded = sheet.value;
  return isOpen && Loaded !== null ? <Loaded /> : null;
}
