/** A field for a number. */
import { useTyped } from "./controls.js";

interface NumberInputProps {
  id: string;
  "aria-label"?: string;
  placeholder?: string;
  min?: string;
  max?: number | undefined;
  step?: string;
  value: string | number;
  /** Gets NaN when the field is emptied. */
  onEnter(number: number): void;
}

export const NumberInput = ({ value, onEnter, ...input }: NumberInputProps) => (
  <input
    type="number"
    step="any"
    inputMode="decimal"
    {...input}
    {...useTyped(value, (text) => onEnter(Number.parseFloat(text)))}
  />
);
