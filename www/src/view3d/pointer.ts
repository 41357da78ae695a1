/** Pointer events of the canvas: clicks, double clicks, hovering. */

/** A press that moves farther than this, in CSS pixels, is a drag and not a click. */
const clickPx = 5;

/** A place on the canvas, CSS pixels from the left and top. */
export interface Place {
  x: number;
  y: number;
}

/** Pointer events. */
export interface PointerEvents {
  onClick(place: Place): void;
  onDoubleClick(place: Place): void;
  /** At most once per frame, while no button is pressed; `null` when the pointer leaves. */
  onHover(place: Place | null): void;
}

/** Listens to a canvas until `dispose` is called. */
export class Pointer {
  private readonly listeners = new AbortController();
  private frame = 0;

  constructor(canvas: HTMLCanvasElement, events: PointerEvents) {
    const { signal } = this.listeners;
    const place = (event: MouseEvent): Place => {
      const { left, top } = canvas.getBoundingClientRect();
      return { x: event.clientX - left, y: event.clientY - top };
    };
    const on = <K extends keyof HTMLElementEventMap>(type: K, act: (event: HTMLElementEventMap[K]) => void) =>
      canvas.addEventListener(type, act, { signal });
    let pressed: (Place & { id: number }) | null = null;
    on("pointerdown", (event) => {
      // A gesture with two fingers is not a click.
      pressed = pressed === null && event.button === 0 ? { ...place(event), id: event.pointerId } : null;
    });
    on("pointerup", (event) => {
      const [from, to] = [pressed, place(event)];
      pressed = null;
      if (from?.id === event.pointerId && Math.hypot(to.x - from.x, to.y - from.y) <= clickPx) events.onClick(to);
    });
    on("pointercancel", () => {
      pressed = null;
    });
    on("dblclick", (event) => events.onDoubleClick(place(event)));
    on("pointermove", (event) => {
      if (event.buttons !== 0) return;
      cancelAnimationFrame(this.frame);
      this.frame = requestAnimationFrame(() => events.onHover(place(event)));
    });
    on("pointerleave", () => {
      cancelAnimationFrame(this.frame);
      events.onHover(null);
    });
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.listeners.abort();
  }
}
