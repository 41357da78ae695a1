/** Keys of the canvas: arrows orbit, plus and minus come nearer and go away. */

/** How far a key turns the view, degrees, and the factor by which it changes the distance. */
const [KEY_DEG, KEY_ZOOM] = [6, 1.15];

const turns: Readonly<Record<string, readonly [right: number, up: number]>> = {
  ArrowLeft: [-KEY_DEG, 0],
  ArrowRight: [KEY_DEG, 0],
  ArrowUp: [0, KEY_DEG],
  ArrowDown: [0, -KEY_DEG],
};

/** Listens to a canvas, for as long as it exists. */
export function listenToOrbitKeys(
  canvas: HTMLCanvasElement,
  orbit: (rightDeg: number, upDeg: number, factor: number) => void,
): void {
  canvas.tabIndex = 0;
  canvas.addEventListener("keydown", (event) => {
    const factor = event.key === "+" ? 1 / KEY_ZOOM : event.key === "-" ? KEY_ZOOM : 1;
    const turn = turns[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || (turn === undefined && factor === 1)) return;
    event.preventDefault();
    const [right, up] = turn ?? [0, 0];
    orbit(right, up, factor);
  });
}
