/** Controls that several panels use. */
import type { ComponentChildren, TargetedEvent } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import { filesOf } from "../input/files.js";
import type { NamedFile } from "../state/inputs.js";

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

interface CheckProps {
  id?: string;
  title: string;
  checked: boolean;
  disabled?: boolean;
  onCheck(checked: boolean): void;
}

/** A box to tick. */
export const Check = ({ title, onCheck, ...box }: CheckProps) => (
  <label class="check">
    <input type="checkbox" {...box} onChange={({ currentTarget }) => onCheck(currentTarget.checked)} />
    <span>{title}</span>
  </label>
);

/**
 * Attributes of a field that keeps the typed text until it is entered or left, even if the field is redrawn meanwhile.
 * @param value - What the field shows otherwise.
 */
export function useTyped(value: string | number, onEnter: (text: string) => void) {
  const [typed, setTyped] = useState<string | null>(null);
  return {
    value: typed ?? value,
    onInput: ({ currentTarget }: TargetedEvent<HTMLInputElement>) => setTyped(currentTarget.value),
    onChange: ({ currentTarget }: TargetedEvent<HTMLInputElement>) => {
      setTyped(null);
      onEnter(currentTarget.value);
    },
    onBlur: () => setTyped(null),
  };
}

interface TextFieldProps {
  id: string;
  title: string;
  value: string;
  onEnter(text: string): void;
}

/** A field for a text. */
export const TextField = ({ id, title, value, onEnter }: TextFieldProps) => (
  <label class="field-inline">
    <span>{title}</span>
    <input id={id} {...useTyped(value, onEnter)} />
  </label>
);

interface FileButtonProps {
  id: string;
  accept?: string;
  multiple?: boolean;
  webkitdirectory?: boolean;
  "aria-invalid"?: boolean;
  "aria-describedby"?: string | undefined;
  /** Classes beside `button`. */
  look?: string;
  children: ComponentChildren;
  onFiles(files: NamedFile[]): void;
}

/** A button that chooses files. */
export const FileButton = ({ look = "", children, onFiles, ...input }: FileButtonProps) => (
  <label class={`button ${look}`}>
    {children}
    <input
      {...input}
      class="visually-hidden"
      type="file"
      onChange={({ currentTarget }) => {
        const files = filesOf(currentTarget);
        // Otherwise choosing the same file again, for example after correcting it, would fire no event.
        currentTarget.value = "";
        onFiles(files);
      }}
    />
  </label>
);

/** Distance of an explanation from the edge of the window, in pixels. */
const MARGIN = 8;

interface PopoverProps {
  /** The accessible name of the button, if its title is none. */
  label?: string;
  title: string;
  /** Class of the button; the box has the same with "-box". */
  look: "tip" | "menu";
  /** Whether the title is a symbol. */
  isIcon?: boolean;
  children: ComponentChildren;
}

/** A button that opens a box beside it. */
function Popover({ label, title, look, isIcon = false, children }: PopoverProps) {
  const id = useId();
  const button = useRef<HTMLButtonElement>(null);
  const popover = useRef<HTMLDivElement>(null);

  /** Actions close the box; what is set in it leaves it open. */
  const onClick = ({ target }: Event) => {
    if (target instanceof Element && target.closest("button") !== null) popover.current?.hidePopover();
  };
  const position = () => {
    const [anchor, box] = [button.current, popover.current];
    if (anchor === null || box === null) return;
    const place = anchor.getBoundingClientRect();
    const size = box.getBoundingClientRect();
    const wanted = look === "tip" ? place.left - size.width / 2 : place.left;
    const fitsBelow = place.bottom + 6 + size.height < innerHeight;
    // The button itself may be out of sight, if a command opens the box.
    const inside = (at: number, length: number, all: number) => Math.max(MARGIN, Math.min(at, all - length - MARGIN));
    const top = fitsBelow ? place.bottom + 6 : place.top - size.height - 6;
    box.style.left = `${inside(wanted, size.width, innerWidth)}px`;
    box.style.top = `${inside(top, size.height, innerHeight)}px`;
  };
  return (
    <>
      <button type="button" class={isIcon ? `${look} icon` : look} ref={button} popoverTarget={id} aria-label={label}>
        {title}
      </button>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: its buttons are operated by keys, which click them. */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: for the same reason. */}
      <div id={id} popover="auto" class={`${look}-box`} ref={popover} onToggle={position} onClick={onClick}>
        {children}
      </div>
    </>
  );
}

/** A button that opens an explanation. */
export const Tip = ({ label, children }: { label: string; children: ComponentChildren }) => (
  <Popover look="tip" title="?" label={`About ${label}`}>
    {children}
  </Popover>
);

/** A button that opens further controls. */
export const Menu = (menu: Omit<PopoverProps, "look">) => <Popover look="menu" {...menu} />;

const pictograms = {
  hidden: {
    title: "hidden",
    path: "M1 8s2.5-4.5 7-4.5S15 8 15 8s-2.5 4.5-7 4.5S1 8 1 8zM2.5 13.5l11-11",
  },
  locked: { title: "locked", path: "M3.5 7.5h9v6h-9zM5.5 7.5V5a2.5 2.5 0 0 1 5 0v2.5" },
} as const;

export function Icon({ name }: { name: keyof typeof pictograms }) {
  const { path, title } = pictograms[name];
  return (
    <svg class="icon" viewBox="0 0 16 16" width="16" height="16" role="img" aria-label={title}>
      <path d={path} fill="none" stroke="currentColor" stroke-width="1.4" stroke-linejoin="round" />
    </svg>
  );
}

interface PictureProps {
  /** Null draws nothing. */
  image: ImageData | null;
  /** Empty where a text beside the picture says it all. */
  label: string;
  class?: string;
}

const HIDDEN = { "aria-hidden": true } as const;

export function Picture({ image, label, class: className = "thumb" }: PictureProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (canvas.current === null || image === null) return;
    canvas.current.width = image.width;
    canvas.current.height = image.height;
    canvas.current.getContext("2d")?.putImageData(image, 0, 0);
  }, [image]);
  return image === null ? (
    <span class={className} />
  ) : (
    <canvas ref={canvas} class={className} {...(label === "" ? HIDDEN : { role: "img", "aria-label": label })} />
  );
}
