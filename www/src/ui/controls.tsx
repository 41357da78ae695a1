/** Controls that several panels use. */
import type { ComponentChildren } from "preact";
import { useId, useRef } from "preact/hooks";

interface ChoicesProps<V extends string> {
  id?: string;
  /** Required unless a `<label>` names the element. */
  label?: string;
  value: V;
  choices: readonly (readonly [value: V, title: string])[];
  onChoose(value: V): void;
}

/** A drop-down list. */
export function Choices<V extends string>({ id, label, value, choices, onChoose }: ChoicesProps<V>) {
  return (
    <select
      id={id}
      aria-label={label}
      value={value}
      onChange={({ currentTarget }) => onChoose(currentTarget.value as V)}
    >
      {choices.map(([value, title]) => (
        <option key={value} value={value}>
          {title}
        </option>
      ))}
    </select>
  );
}

/** Distance of an explanation from the edge of the window, in pixels. */
const MARGIN = 8;

/** A button that opens an explanation. */
export function Tip({ label, children }: { label: string; children: ComponentChildren }) {
  const id = useId();
  const button = useRef<HTMLButtonElement>(null);
  const popover = useRef<HTMLDivElement>(null);

  const position = () => {
    const [anchor, box] = [button.current, popover.current];
    if (anchor === null || box === null) return;
    const place = anchor.getBoundingClientRect();
    const size = box.getBoundingClientRect();
    const left = Math.min(Math.max(MARGIN, place.left - size.width / 2), innerWidth - size.width - MARGIN);
    const fitsBelow = place.bottom + 6 + size.height < innerHeight;
    box.style.left = `${left}px`;
    box.style.top = `${fitsBelow ? place.bottom + 6 : Math.max(MARGIN, place.top - size.height - 6)}px`;
  };
  return (
    <>
      <button type="button" class="tip" ref={button} popoverTarget={id} aria-label={`About ${label}`}>
        ?
      </button>
      <div id={id} popover="auto" class="tip-box" ref={popover} onToggle={position}>
        {children}
      </div>
    </>
  );
}
