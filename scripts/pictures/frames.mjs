/** The picture of camera frames: the axes of each, as a camera that looks away from the reader sees them. */

/** Frames, with what uses them. @type {readonly (readonly [frame: string, users: string])[]} */
const frames = [
  ["opencv", "sim3align, RealSense, BOP"],
  ["opengl", "three.js, glTF, Blender"],
  ["pytorch3d", "SAM 3D Objects"],
  ["ros", "robot bodies (REP-103)"],
];

const axes = /** @type {const} */ ([
  ["x", [1, 0, 0], "#c62828"],
  ["y", [0, 1, 0], "#2e7d32"],
  ["z", [0, 0, 1], "#1565c0"],
]);

const LENGTH = 62;

/** The words for directions in the OpenCV frame. @param {readonly number[]} direction */
function wordFor([right = 0, down = 0, forward = 0]) {
  if (right !== 0) return right > 0 ? "right" : "left";
  if (down !== 0) return down > 0 ? "down" : "up";
  return forward > 0 ? "forward" : "backward";
}

/** Projects a direction onto the page: forward points up and to the right. @param {readonly number[]} direction */
const onPage = ([right = 0, down = 0, forward = 0]) => [
  LENGTH * (right + 0.62 * forward),
  LENGTH * (down - 0.5 * forward),
];

/**
 * An SVG.
 * @param {(transform: object, frame: string) => { translation: readonly number[] }} fromFrame that of the package
 */
export function framesPicture(fromFrame) {
  const drawn = frames.map(([frame, users], i) => {
    const arrows = axes.map(([axis, translation, colour]) => {
      const turned = fromFrame({ scale: 1, rotation: [0, 0, 0, 1], translation }, frame).translation.map(Math.round);
      const [x = 0, y = 0] = onPage(turned);
      const anchor = x > 20 ? "start" : x < -20 ? "end" : "middle";
      const [dx, dy] = [anchor === "start" ? 6 : anchor === "end" ? -6 : 0, y > 20 ? 16 : y < -20 ? -8 : 4];
      return `<path d="M0 0L${x} ${y}" stroke="${colour}" stroke-width="3" marker-end="url(#${axis})" />
<text x="${x + dx}" y="${y + dy}" text-anchor="${anchor}" fill="${colour}">${axis} ${wordFor(turned)}</text>`;
    });
    return `<g transform="translate(${120 + 250 * i} 130)">
<text y="-105" text-anchor="middle" fill="#1a1f27" font-weight="600">${frame}</text>
<text y="-86" text-anchor="middle" fill="#545d6b">${users}</text>
${arrows.join("\n")}
</g>`;
  });
  const heads = axes.map(
    ([axis, , colour]) =>
      `<marker id="${axis}" viewBox="0 0 8 8" refX="6" refY="4" markerWidth="4" markerHeight="4" orient="auto"><path d="M0 0L8 4L0 8z" fill="${colour}" /></marker>`,
  );
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 230" font-family="system-ui, sans-serif" font-size="13">
<title>The axes of camera frames</title>
<rect width="1000" height="230" fill="#ffffff" />
<defs>${heads.join("")}</defs>
${drawn.join("\n")}
</svg>
`;
}
