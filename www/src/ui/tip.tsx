/** An explanation that opens beside what it is about: by pointer, by touch, by keyboard. */
import type { ComponentChildren } from "preact";
import { useId, useRef } from "preact/hooks";

/** How far from the window's edge it stays, in pixels. */
const MARGIN = 8;

export function Tip({ label, children }: { label: string; children: ComponentChildren }) {
  const id = useId();
  const button = useRef<HTMLButtonElement>(null);
  const popover = useRef<HTMLDivElement>(null);

  const put = () => {
    const [from, box] = [button.current, popover.current];
    if (from === null || box === null) return;
    const place = from.getBoundingClientRect();
    const size = box.getBoundingClientRect();
    const left = Math.min(Math.max(MARGIN, place.left - size.width / 2), innerWidth - size.width - MARGIN);
    const below = place.bottom + 6 + size.height < innerHeight;
    box.style.left = `${left}px`;
    box.style.top = `${below ? place.bottom + 6 : Math.max(MARGIN, place.top - size.height - 6)}px`;
  };
  return (
    <>
      <button type="button" class="tip" ref={button} popoverTarget={id} aria-label={`What is ${label}?`}>
        ?
      </button>
      <div id={id} popover="auto" class="tip-box" ref={popover} onToggle={put}>
        {children}
      </div>
    </>
  );
}
