/** Parts of a mesh that are of the scene around the object: floors, walls, backdrops. */
import type { CoreMesh } from "../values/prepared-mesh.js";

/** How many times as large as the rest a part is that is named. The largest part of an object is rarely far larger than all others. */
const LARGER = 3;

interface Part {
  triangles: number;
  low: number[];
  high: number[];
}

/**
 * How many times as large as the rest of a mesh its largest parts are, if they are of a scene: the rest has more triangles. `null` for
 * other meshes.
 */
export function largePart(mesh: CoreMesh): number | null {
  const parts = partsOf(mesh).sort((a, b) => diagonal(b) - diagonal(a));
  const all = parts.reduce((sum, { triangles }) => sum + triangles, 0);
  // From the smallest part on, together.
  let rest: Part | undefined;
  for (const part of [...parts].reverse()) {
    const size = rest === undefined ? 0 : diagonal(rest);
    if (rest !== undefined && 2 * rest.triangles > all && size > 0 && diagonal(part) >= LARGER * size) {
      return Math.round(diagonal(parts[0] as Part) / size);
    }
    rest = rest === undefined ? part : together(rest, part);
  }
  return null;
}

const diagonal = ({ low, high }: Part): number => Math.hypot(...high.map((x, axis) => x - (low[axis] as number)));

const together = (a: Part, b: Part): Part => ({
  triangles: a.triangles + b.triangles,
  low: a.low.map((x, axis) => Math.min(x, b.low[axis] as number)),
  high: a.high.map((x, axis) => Math.max(x, b.high[axis] as number)),
});

/** The parts of a mesh that no triangle joins. Vertices at the same place are one. */
function partsOf({ positions, indices }: CoreMesh): Part[] {
  const corners = indices ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  const places = new Map<string, number>();
  const parent = Int32Array.from({ length: positions.length / 3 }, (_, i) => {
    const key = `${positions[3 * i]} ${positions[3 * i + 1]} ${positions[3 * i + 2]}`;
    const place = places.get(key) ?? i;
    places.set(key, place);
    return place;
  });
  const rootOf = (vertex: number): number => {
    let root = vertex;
    while (parent[root] !== root) {
      parent[root] = parent[parent[root] as number] as number;
      root = parent[root] as number;
    }
    return root;
  };
  for (let i = 0; i + 2 < corners.length; i += 3) {
    for (const j of [i + 1, i + 2]) parent[rootOf(corners[i] as number)] = rootOf(corners[j] as number);
  }
  const parts = new Map<number, Part>();
  for (const [i, corner] of corners.entries()) {
    const root = rootOf(corner);
    const part = parts.get(root) ?? { triangles: 0, low: [...infinite], high: infinite.map((x) => -x) };
    parts.set(root, part);
    if (i % 3 === 0) part.triangles += 1;
    for (let axis = 0; axis < 3; axis++) {
      const x = positions[3 * corner + axis] as number;
      part.low[axis] = Math.min(part.low[axis] as number, x);
      part.high[axis] = Math.max(part.high[axis] as number, x);
    }
  }
  return [...parts.values()];
}

const infinite = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
