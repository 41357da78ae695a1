/** The panels of `lazy-panels.tsx` as one script: many small ones compress worse. */
export { Advised, Warnings } from "./advised.js";
export { Alternatives } from "./alternatives.js";
export { Details } from "./details.js";
export { HandPanel } from "./hand-panel.js";
export { OptionsPanel } from "./options-panel.js";
export { Remedies } from "./remedies.js";
